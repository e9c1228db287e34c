#pragma once

#include <string>

namespace homolog {

/// The function `name` of a copy of a shared library that has a C library of its own. So the copy shares no state with
/// the program: no random numbers, no error number. `function`: one of that library, as it is linked. Each call makes a
/// copy, which stays until the program ends. Null where the system makes none.
void* in_namespace_of_its_own(const void* function, const char* name);

/// The function `name` of a module in a file, which is loaded for good. Null where the file or the function is missing;
/// `fault` says why then.
void* in_module(const char* file, const char* name, std::string& fault);

}  // namespace homolog
