#pragma once

#include <string>
#include <tl/expected.hpp>
#include <utility>

#include "core/base/text/text.h"

namespace homolog {

/// Why a file, a user's data or a factorisation was refused: one sentence that names the fault and what would help.
/// `subject` is the file (or option) the sentence is about; empty where there is none.
struct Error {
  std::string subject;
  std::string what;

  /// "SUBJECT: WHAT", as printed after "homolog: " and as shown in the editor: one line without control characters.
  std::string sentence() const {
    constexpr std::size_t longest_path = 4096;
    const std::string of = subject.size() > longest_path ? excerpt(subject) : printable(subject);
    return (of.empty() ? "" : of + ": ") + printable(what);
  }
};

/// A value, or the Error that prevented it. The spelling is that of C++23's std::expected.
template <class T>
using Result = tl::expected<T, Error>;

/// `return fail("mesh.ply", "holds no faces; export it as a triangle mesh");`
inline tl::unexpected<Error> fail(std::string subject, std::string what) {
  return tl::make_unexpected(Error{std::move(subject), std::move(what)});
}
inline tl::unexpected<Error> fail(Error error) {
  return tl::make_unexpected(std::move(error));
}

}  // namespace homolog
