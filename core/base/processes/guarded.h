#pragma once

#include <string>
#include <type_traits>
#include <utility>

#include "core/base/result.h"

namespace homolog {

/// The sentence of the exception that is being handled: no memory, a file that the system refuses, anything else. Call
/// it inside a catch block. `subject`: what the work was about, as in Error; a file that the exception names goes
/// before.
Error error_of_exception(const std::string& subject);

/// Returns the Result of `work`. If `work` throws, returns the exception's sentence as an Error. For the edge of a
/// thread, of a command and of a callback, which no exception may pass.
template <class Work>
std::invoke_result_t<Work> guarded(const std::string& subject, Work&& work) {
  try {
    return std::forward<Work>(work)();
  } catch (...) {
    return fail(error_of_exception(subject));
  }
}

}  // namespace homolog
