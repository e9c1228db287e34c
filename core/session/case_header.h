#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/base/processes/progress.h"
#include "core/session/case_templates.h"

namespace homolog {

// The first line of a case file: the files that it is made of, and where the template lies.

/// For this document: volume, template (paths relative to `folder`), placement, vertices, connectivity hash, series
/// UID, voxels, spacing and geometry hash, and how a verb made the case (empty: none did). Errors: a path that is no
/// UTF-8.
Result<std::string> case_header(const Document& document, const std::filesystem::path& folder,
                                const std::string& record);

/// The same line for a case that goes on in `folder` with the files of `document`, and with a label map (empty: none);
/// all other keys stay as they are. Errors: a line that is no header, a path that is no UTF-8.
/// `templates`: what the lines behind it name.
Result<std::string> moved_header(const std::string& line, const Document& document, const std::filesystem::path& labels,
                                 const CaseTemplates& templates, const std::filesystem::path& folder);

/// The label map that is shown over the image; empty where a header names none. Errors: it is no text.
Result<std::filesystem::path> labels_in_header(const nlohmann::ordered_json& header,
                                               const std::filesystem::path& folder);

/// The templates that the lines behind a header name: relative to which folder, and whether they name any. Errors: the
/// folder is no text.
Result<CaseTemplates> templates_in_header(const nlohmann::ordered_json& header, const std::filesystem::path& folder);

/// How a header's image is taken.
struct ImageOfHeader {
  std::string source;  ///< the image's file now; empty: as the header says
  bool read = true;    ///< else the document has its name alone
  bool voxels = true;  ///< else its grid and frames are enough [VolumeReadOptions::without_voxels]
};

/// Loads what a header names; paths are relative to `folder`. Errors: no header, a missing volume or template, a
/// mismatch of vertices, connectivity, series or geometry (both values named).
Result<Document> read_header(const nlohmann::ordered_json& header, const std::filesystem::path& folder,
                             const ImageOfHeader& image, Progress* progress, std::vector<std::string>& warnings);

}  // namespace homolog
