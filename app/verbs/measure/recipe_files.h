#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "app/verbs/measure/measure_recipe.h"
#include "core/measure/recipe/measuring.h"

namespace homolog {

/// Which shape is measured.
struct OfCase {
  std::string file;                ///< as ReadShape names it
  std::vector<std::string> stems;  ///< what files of its own may be called
  std::string group;
  std::optional<int> frame{};
  std::filesystem::path source{};  ///< the file that it was read from, or the folder of several
};

/// The landmarks and images that lie in files of their own, of each shape those of its name.
class FilesOfShapes {
 public:
  explicit FilesOfShapes(const RecipeJob& job) : job_(job) {}

  /// Landmarks that lie in files of their own; they count before those of the mesh. `alone`: one shape is measured.
  /// Errors: a file cannot be read; one file for several shapes; one that may be of two shapes.
  Result<void> add_landmarks(const OfCase& of, bool alone, MeasuredStructure& structure);
  /// The image that is sampled along normals: one for all, or of the shape's name. `name`: the shape's, in warnings.
  /// It is held here until the next call. Errors: it cannot be read; it has no such frame.
  Result<void> add_image(const OfCase& of, const std::string& name, MeasuredShape& shape,
                         std::vector<std::string>& warnings);

 private:
  const RecipeJob& job_;
  std::map<std::filesystem::path, std::filesystem::path> landmarks_taken_, images_taken_;  ///< the shape by the file
  Volume image_;                                                                           ///< of `image_file_`
  std::filesystem::path image_file_;
};

}  // namespace homolog
