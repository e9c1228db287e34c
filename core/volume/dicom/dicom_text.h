#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/volume/dicom/dicom_set.h"

namespace homolog {

/// The alphabets in which a file writes its texts [DICOM PS3.5, 6.1 and annexes H to K].
class DicomAlphabets {
 public:
  /// Those that the file names (0008,0005).
  explicit DicomAlphabets(const DicomItem& data);

  /// A text as UTF-8 without control characters [segment_name]. Nothing where its letters are of an alphabet that is
  /// not known here, or are none of it. Without alphabets, and with those of Latin-1, text that is UTF-8 is taken for
  /// it, since many programs do not say so.
  std::optional<std::string> read(const std::string& text) const;

  /// The same of an element; where its letters cannot be read, each of them becomes '?', and `unread` is set.
  std::string name_of(const DicomItem& item, DicomTag tag, bool& unread) const;

  /// The alphabets as the file names them, for sentences.
  const std::string& words() const { return words_; }

 private:
  std::string words_;
  std::vector<std::string> names_;
};

/// The warning that names in a file could not be read.
std::string unread_names(const std::string& path, const DicomAlphabets& alphabets);

}  // namespace homolog
