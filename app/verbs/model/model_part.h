#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "core/base/result.h"
#include "core/mesh/mesh_io.h"
#include "core/model/shape_model.h"

namespace homolog {

/// A model, or one structure of a joint model in all of its modes [part_of]; empty: all of it. Errors: read_model's, a
/// structure that the model does not have.
Result<ShapeModel> read_model_part(const std::filesystem::path& path, const std::string& structure);

/// The mean of a model, or with a seed one of its random shapes [sampled_shape], as a mesh; LPS mm. `structure`: as
/// read_model_part.
Result<MeshFile> mesh_of_model(const std::filesystem::path& path, const std::string& structure,
                               std::optional<std::uint64_t> seed);

}  // namespace homolog
