#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/volume/dicom/dicom_set.h"

namespace homolog {

/// Elements to be written, by their tags: explicit type, little-endian [DICOM PS3.5, §7.1.2].
class DicomElements {
 public:
  /// A text or bytes as they are; of odd length, they are padded as their type `vr` asks. One that is longer than its
  /// type can be stays empty, and check() tells.
  DicomElements& put(DicomTag tag, const char* vr, const std::string& value);
  /// Numbers of 16 bits (US) or 32 bits (UL).
  DicomElements& put_shorts(DicomTag tag, const std::vector<std::uint16_t>& values);
  DicomElements& put_longs(DicomTag tag, const std::vector<std::uint32_t>& values);
  /// Decimal strings of at most 16 characters.
  DicomElements& put_decimals(DicomTag tag, const std::vector<double>& values);
  /// Tags as values (AT).
  DicomElements& put_tag(DicomTag tag, DicomTag value);
  /// A sequence of these items.
  DicomElements& put_items(DicomTag tag, const std::vector<DicomElements>& items);

  /// Errors: an element, or one of an item, was longer than its type can be.
  Result<void> check() const;
  /// All of them, in ascending order.
  std::string bytes() const;

 private:
  std::map<DicomTag, std::string> elements_;
  std::optional<DicomTag> too_long_;  ///< the first
};

}  // namespace homolog
