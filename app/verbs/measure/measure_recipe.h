#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/verbs/verb.h"

namespace homolog {

/// The arguments of `measure --recipe`.
struct RecipeJob {
  std::vector<std::filesystem::path> files;
  bool all_frames = false;
  std::string group;
  std::string recipe;               ///< a file, or the name of one that ships; empty: that of the template
  std::string the_template;         ///< lends landmarks and regions; empty: none
  std::filesystem::path landmarks;  ///< one shape's file, or a folder with a file of each shape's name; empty: none
  std::filesystem::path model;      ///< empty: none
  int modes = 3;
  std::filesystem::path image;  ///< the image of all shapes, or a folder with a file of each shape's name; empty: none
  std::filesystem::path out;    ///< the table; empty: none
  std::filesystem::path profiles;  ///< a folder for meshes with the image along normals; empty: none
};

/// Every measurement of a recipe on every shape, and along the modes of a model.
Result<Report> measure_by_recipe(const RecipeJob& job, Progress& progress);

}  // namespace homolog
