#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace homolog {

/// Numbers as a JSON string holds them, a few times smaller than as text and exact. Their bytes lie in planes, the
/// lowest byte of every number first, since the high bytes are much alike; zlib compresses them, base64 makes text of
/// them. For std::uint8_t, std::uint32_t and double (as its 64 bits).
template <class Number>
std::string packed(std::span<const Number> numbers);

/// The `count` numbers that `packed` made `text` of. Errors: text that is damaged or of another count.
template <class Number>
Result<std::vector<Number>> unpacked(std::string_view text, std::size_t count);

}  // namespace homolog
