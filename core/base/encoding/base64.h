#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace homolog {

/// Bytes as text [RFC 4648, section 4].
std::string to_base64(std::span<const unsigned char> bytes);
/// The bytes of such text. Empty where it is no base64.
std::vector<unsigned char> from_base64(std::string_view text);

}  // namespace homolog
