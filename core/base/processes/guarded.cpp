#include "core/base/processes/guarded.h"

#include <exception>
#include <filesystem>
#include <new>
#include <stdexcept>

namespace homolog {

namespace {

Error no_memory(const std::string& subject) {
  if (subject.empty()) return {"", "This needs more memory than there is; close other programs."};
  return {subject, "needs more memory than there is; close other programs"};
}

}  // namespace

Error error_of_exception(const std::string& subject) {
  try {
    throw;
  } catch (const std::bad_alloc&) {
    return no_memory(subject);
  } catch (const std::length_error&) {  // a vector was asked for more than any memory holds
    return no_memory(subject);
  } catch (const std::filesystem::filesystem_error& error) {
    const std::string path = error.path1().string();
    return {path.empty() ? subject : path, error.code().message() + "; check that it is there and may be used"};
  } catch (const std::exception& error) {
    return {subject, "ended in an unexpected fault (" + std::string(error.what()) + "); please report it"};
  } catch (...) {
    return {subject, "ended in an unexpected fault; please report it"};
  }
}

}  // namespace homolog
