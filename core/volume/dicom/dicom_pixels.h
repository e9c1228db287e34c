#pragma once

#include <cstddef>
#include <vector>

#include "core/base/processes/progress.h"
#include "core/base/result.h"
#include "core/volume/dicom/dicom_header.h"

namespace homolog {

/// The type in which a file stores its pixels; fails on colour and on sizes other than 8, 16 and 32 bits.
Result<Scalar> dicom_stored_type(const DicomHeader& header);

/// Whether its planes are packed by run lengths, which make at most 64 bytes of one.
bool is_run_length_encoded(const DicomHeader& header);

/// Refuses sizes that a file's pixels cannot hold, before memory is taken for them. `plane_bytes`: of a decoded plane.
Result<void> check_pixel_claim(const DicomHeader& header, std::size_t plane_bytes);

/// Refuses pixels whose transfer syntax changes values, as labels do not bear.
Result<void> check_exact(const DicomHeader& header);

/// Reads and decodes all planes of a file, in its order, as rows · columns values of its stored type each, into room
/// that is asked for as they arrive: what a header claims costs no memory before there are pixels for it. Fails where
/// pixels are missing or do not decode.
Result<void> read_dicom_pixels(const DicomHeader& header, const Room& room, Progress* progress);

/// Reads pixels of one bit, `bytes` bytes in all: behind one another across the planes, or where the file keeps each
/// plane in a fragment, each from a byte of its own. Fails as read_dicom_pixels does.
Result<void> read_dicom_bits(const DicomHeader& header, std::size_t bytes, std::vector<std::byte>& bits,
                             Progress* progress);

}  // namespace homolog
