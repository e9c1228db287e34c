#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/verbs/record.h"
#include "app/verbs/verb.h"
#include "core/mesh/mesh_io.h"
#include "core/template/template.h"
#include "core/template_making/tube_template.h"

namespace homolog {

/// The job that the verb `template` is asked for.
struct TemplateJob {
  std::filesystem::path in, out, landmarks;
  std::vector<std::filesystem::path> consensus, best_of;  ///< several subjects in place of `in`; a folder opens
  bool flip_mirrored = false;
  std::string label;
  std::optional<int> frame;
  std::optional<double> level;      ///< the level of soft masks
  std::optional<FacedNames> faced;  ///< the part of the label's surface to take
  int vertices = 2500;
  std::optional<double> closing_mm, opening_mm;
  std::string genus = "auto", parts = "largest", holes = "small";
  bool keep_vertices = false;
  bool tube = false, capped = false;
  int rings = TubeTemplateOptions{}.rings, sectors = TubeTemplateOptions{}.sectors, outer_label = 0;
  std::vector<double> axis, base, apex;
  GivenCommand command;  ///< the command, for the record of its file
};

/// A template that is not written yet.
struct MadeTemplate {
  MeshFile file;
  Json values = Json::object();  ///< the report's values beside its mesh
  std::vector<std::string> warnings;
  std::vector<std::string> of_reading{};  ///< warnings of the file that it is made of, whatever label is taken
};

/// Makes a template of one subject, `options.in`. `choose_closing`: the closing radius of a label is tried where none
/// is given; else it is the usual one. Errors: the file cannot be read; no template can be made of it; options that
/// have no effect on it.
Result<MadeTemplate> make_template_of_one(const TemplateJob& options, bool choose_closing, Progress& progress);

/// Makes one of several subjects: their mean shape, or that one of them which suits the others best.
Result<MadeTemplate> make_template_of_many(const TemplateJob& options, Progress& progress);

}  // namespace homolog
