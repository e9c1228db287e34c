#include "core/base/processes/system_modules.h"

#include <dlfcn.h>

namespace homolog {

void* in_namespace_of_its_own(const void* function, const char* name) {
  Dl_info library{};
  if (::dladdr(function, &library) == 0) return nullptr;
  void* copy = ::dlmopen(LM_ID_NEWLM, library.dli_fname, RTLD_NOW | RTLD_LOCAL);
  return copy == nullptr ? nullptr : ::dlsym(copy, name);
}

void* in_module(const char* file, const char* name, std::string& fault) {
  void* module = ::dlopen(file, RTLD_NOW | RTLD_LOCAL);
  void* found = module == nullptr ? nullptr : ::dlsym(module, name);
  if (const char* text = found == nullptr ? ::dlerror() : nullptr) fault = text;
  return found;
}

}  // namespace homolog
