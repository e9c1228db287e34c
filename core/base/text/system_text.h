#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace homolog {

/// Text in an encoding of that name (as iconv knows it: "ISO-8859-5") as UTF-8. Nothing where the text is not in that
/// encoding, or where the system does not know it.
std::optional<std::string> utf8_of(std::string_view text, const char* encoding);

}  // namespace homolog
