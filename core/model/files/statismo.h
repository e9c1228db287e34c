#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/base/result.h"
#include "core/model/files/hdf_tree.h"
#include "core/model/shape_model.h"

namespace homolog {

/// Whether the name ends as a model's does: .h5 or .h5.json.
bool is_model_name(const std::filesystem::path& path);

/// The parts of a file that read_model reads.
HdfParts model_parts();

/// Writes a model in the layout of statismo and scalismo 0.9 (docs/models.md), `.h5.json` or `.h5` by extension, whole
/// or not at all. Numbers become float, which both programs insist on; the basis is orthonormal, coordinates are LPS
/// mm. `record`: how the model was made [file_record.h], as /homolog/record. Errors: another extension, the file cannot
/// be written.
Result<void> write_model(const ShapeModel& model, const std::filesystem::path& path, const std::string& record = {});

/// The record of a model; none where it has none. Errors: those of reading its tree.
Result<std::optional<std::string>> read_model_record(const std::filesystem::path& path);

/// Reads a model of that layout, of whichever program: 0.9, 1.x, or 0.8, whose basis holds √λ. A triangle mesh
/// (POLYGON_MESH) or points alone (POINT_SET). Errors: not a model, another version or kind of data, parts that do not
/// fit each other, numbers that are not finite, negative variances, faces that are no manifold surface.
Result<ShapeModel> read_model(const std::filesystem::path& path);

}  // namespace homolog
