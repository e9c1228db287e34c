#pragma once

#include <cstddef>
#include <span>

namespace homolog {

/// Decodes one plane in DICOM's run-length encoding [DICOM PS3.5, annex G] into values of `value_bytes` bytes, native
/// byte order, as many as `out` holds. False where the fragment is not whole and consistent: its header must name as
/// many segments as a value has bytes, in ascending order within the fragment, and each must give exactly its byte of
/// every value.
bool decode_rle(std::span<const char> fragment, std::size_t value_bytes, std::span<std::byte> out);

}  // namespace homolog
