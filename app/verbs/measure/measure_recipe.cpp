#include "app/verbs/measure/measure_recipe.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <optional>
#include <set>

#include "app/verbs/case_landmarks.h"
#include "app/verbs/measure/recipe_files.h"
#include "app/verbs/measure/recipe_report.h"
#include "core/base/files/files.h"
#include "core/base/text/listed.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/files/mesh_frame.h"
#include "core/mesh/repair/inside_out.h"
#include "core/model/files/model_files.h"
#include "core/model/files/statismo.h"
#include "core/model/joint_models/structure_files.h"
#include "core/model/shapes/recipe_shapes.h"

namespace homolog {

namespace {

/// Measures shapes one after the other, as they are read.
class RecipeWork {
 public:
  RecipeWork(const RecipeJob& job, Recipe recipe) : job_(job), files_(job) { measured_.recipe = std::move(recipe); }

  Result<Report> run(Progress& progress) {
    if (!job_.the_template.empty()) {
      auto lender = load_template(job_.the_template);
      if (!lender) return fail(lender.error());
      lenders_.add(std::move(*lender));
    }
    progress.part(0, job_.model.empty() ? 1 : 0.8);
    if (auto read = read_all(progress); !read) return fail(read.error());
    name_cases();
    for (const MeasuredCase& one : measured_.cases) note_missing(one.name, one.values);
    if (!job_.model.empty()) {
      progress.part(0.8, 1);
      if (auto along = measure_model(progress); !along) return fail(along.error());
    }
    say_missing();
    return report_of_measured(job_, measured_, std::move(warnings_));
  }

 private:
  /// Folders of cases with a mesh for each structure, where the recipe names structures; all else as shapes.
  Result<void> read_all(Progress& progress) {
    const std::vector<std::string> structures = measured_.recipe.structures();
    std::vector<std::filesystem::path> files, folders;
    std::error_code ignored;
    for (const auto& file : job_.files)
      (!structures.empty() && std::filesystem::is_directory(file, ignored) ? folders : files).push_back(file);
    if (!folders.empty() && !job_.group.empty())
      return fail(folders.front().string(), "belongs to no group; only the cases of a study (.study.json) have groups");
    if (!folders.empty() && job_.all_frames)
      return fail("--all-frames", "has no effect on a folder of cases; name the case files of cines");
    if (!folders.empty())
      if (auto read = read_folders(folders, structures, progress); !read) return read;
    if (files.empty()) return {};
    const auto sources = shape_sources(files, job_.group);
    if (!sources) return fail(sources.error());
    alone_ = sources->size() == 1 && folders.empty();
    if (auto safe = check_profiles(*sources); !safe) return safe;
    const auto take = [&](ReadShape shape) -> Result<void> {
      MeasuredShape measured;
      if (auto added = add_structure(measured, shape.name, shape.structure, *shape.mesh); !added)
        return fail(shape.name, added.error().what);
      for (const auto& [name, mesh] : shape.others)
        if (auto added = add_structure(measured, shape.name, name, *mesh); !added)
          return fail(shape.name, added.error().what);
      OfCase of{shape.name, {case_name_of(shape.of->file)}, shape.of->group, noted_frame(*shape.mesh), shape.of->file};
      if (!shape.of->study_case.empty()) of.stems.push_back(shape.of->study_case);
      return measure_one(of, std::move(measured));
    };
    const auto warnings = read_shapes(*sources, {job_.all_frames}, take, &progress);
    if (!warnings) return fail(warnings.error());
    warnings_.insert(warnings_.end(), warnings->begin(), warnings->end());
    return {};
  }

  Result<void> read_folders(const std::vector<std::filesystem::path>& folders,
                            const std::vector<std::string>& structures, Progress& progress) {
    const auto cases = structure_files(folders, structures, ShapeWorksFrame::local, 1);
    if (!cases) return fail(cases.error());
    for (const CaseFiles& one : *cases)
      if (auto safe = check_profiles(one.of_structure); !safe) return safe;
    double done = 0;
    for (const CaseFiles& one : *cases) {
      if (progress.cancelled()) return fail("", "the measurements were cancelled");
      progress.report(done++ / static_cast<double>(cases->size()));
      MeasuredShape shape;
      for (std::size_t k = 0; k < structures.size(); ++k) {
        const ShapeSource& source = one.of_structure[k];
        if (k == 0) shape.lacks_first = structures[k];
        if (source.file.empty()) continue;
        const auto mesh = read_shape(source);
        if (!mesh) {
          warnings_.push_back(mesh.error().sentence() + " (left out)");
          continue;
        }
        if (auto added = add_structure(shape, source.file.string(), structures[k], **mesh); !added)
          return fail(source.file.string(), added.error().what);
        if (k == 0) shape.lacks_first.clear();
      }
      if (shape.structures.empty()) continue;
      OfCase of{one.name, {one.name}, {}};
      for (const ShapeSource& source : one.of_structure)
        if (of.source.empty()) of.source = source.file.parent_path();
      if (auto measured = measure_one(of, std::move(shape)); !measured) return measured;
    }
    return {};
  }

  /// Errors: shapes that are read lie where profiles are written.
  Result<void> check_profiles(const std::vector<ShapeSource>& sources) const {
    if (job_.profiles.empty()) return {};
    std::vector<std::filesystem::path> read, there;
    for (const ShapeSource& source : sources) {
      if (source.file.extension() != ".vtp") continue;
      read.push_back(source.file);
      there.push_back(job_.profiles / source.file.filename());
    }
    return check_not_read(there, read);
  }

  /// `shape_name`: in warnings.
  Result<void> add_structure(MeasuredShape& shape, const std::string& shape_name, const std::string& name,
                             const MeshFile& mesh) {
    auto structure = measured_structure(name, mesh, faces_);
    if (!structure) return fail(structure.error());
    if (structure->mesh.topology)
      if (const auto inward = inside_out(structure->mesh)) warnings_.push_back(shape_name + ": " + *inward);
    shape.structures.push_back(std::move(*structure));
    return {};
  }

  Result<void> measure_one(const OfCase& of, MeasuredShape shape) {
    const std::string name = names_.next(of.file);
    if (shape.lacks_first.empty())
      if (auto placed = files_.add_landmarks(of, alone_, shape.structures.front()); !placed) return placed;
    if (auto seen = files_.add_image(of, name, shape, warnings_); !seen) return seen;
    template_suits_ = lenders_.lend_to(shape) || template_suits_;
    if (!job_.model.empty() && measured_.cases.empty()) first_ = shape;
    measured_.cases.push_back({name, of.file, of.group, of.frame, measure(measured_.recipe, shape)});
    return job_.profiles.empty() ? Result<void>() : write_profiles(name, shape);
  }

  /// Gives the cases the names that tables have, of equal ones with their folders.
  void name_cases() {
    std::vector<std::string> files;
    for (const MeasuredCase& one : measured_.cases) files.push_back(one.file);
    const auto names = names_with_folders(files);
    for (std::size_t k = 0; k < measured_.cases.size(); ++k) measured_.cases[k].name = names[k];
  }

  /// The first structure of a shape with the image along its normals, an array for each offset and one of their mean.
  Result<void> write_profiles(const std::string& name, const MeasuredShape& shape) {
    const MeasuredStructure& structure = shape.structures.front();
    if (shape.image == nullptr || structure.mesh.topology == nullptr) return {};
    MeshFile file;
    file.points = structure.mesh.points;
    file.triangles = structure.mesh.topology;
    for (const std::size_t k : measured_.recipe.measurements) {
      const RecipeStep& step = measured_.recipe.steps[k];
      if (step.unit != "image") continue;
      const auto offset_mm = [&](const char* key) {
        const auto found = step.given.find(key);
        return found == step.given.end() || !found->second.steps.empty() ? 0.0 : found->second.numbers.front();
      };
      constexpr int offsets = 9;
      const NormalProfile profile = profile_along_normals(structure.mesh, *shape.image, shape.frame,
                                                          offset_mm("from_mm"), offset_mm("to_mm"), offsets);
      file.values[step.name] = profile.mean();
      for (int at = 0; at < offsets; ++at) {
        char offset[40];
        std::snprintf(offset, sizeof offset, " at %+.2f mm", profile.offsets_mm[at]);
        file.values[step.name + offset] = profile.values.col(at);
      }
    }
    if (file.values.empty())
      return fail("--profiles", "has no effect here: the recipe has no measurement of the kind image_mean");
    if (auto made = make_folder(job_.profiles); !made) return made;
    return write_mesh_file(file, job_.profiles / (name + ".vtp"));
  }

  Result<void> measure_model(Progress& progress) {
    const auto model = read_model(job_.model);
    if (!model) return fail(model.error());
    const int there = static_cast<int>(model->modes());
    if (job_.modes > there)
      warnings_.push_back(job_.model.string() + ": has " + std::to_string(there) + " modes, so these are measured");
    Lenders lenders = lenders_;
    if (first_) lenders.add(*first_);  // the model's shapes have no landmarks of their own
    auto along = measure_modes(measured_.recipe, *model, std::min(job_.modes, there), lenders, progress);
    if (!along) return fail(along.error());
    measured_.modes = std::move(*along);
    if (!measured_.modes.empty()) note_missing("the model", measured_.modes.front().values);
    return {};
  }

  /// Remembers why a shape lacks measurements, by the reason.
  void note_missing(const std::string& name, const std::vector<MeasuredNumber>& values) {
    for (std::size_t k = 0; k < values.size(); ++k) {
      const RecipeStep& step = measured_.recipe.steps[measured_.recipe.measurements[k]];
      if (values[k].value || step.optional) continue;
      missing_[name][values[k].missing].push_back(step.name);
    }
  }

  /// A sentence for each shape and reason; one for all where all shapes lack the same.
  void say_missing() {
    if (!job_.the_template.empty() && !template_suits_)
      warnings_.push_back(unsuited_template(job_.the_template, "the shapes"));
    std::map<std::string, std::size_t> shapes_without;
    for (const auto& [name, reasons] : missing_)
      for (const auto& [reason, unused] : reasons) ++shapes_without[reason];
    std::set<std::string> said;
    const std::size_t all = measured_.cases.size() + (measured_.modes.empty() ? 0 : 1);
    for (const auto& [name, reasons] : missing_)
      for (const auto& [reason, measurements] : reasons) {
        const bool of_all = all > 1 && shapes_without[reason] == all;
        if (of_all && !said.insert(reason).second) continue;
        warnings_.push_back((of_all ? std::string("every shape") : name) + ": " + reason + ", so " +
                            listed(measurements, " and ") + (measurements.size() == 1 ? " is" : " are") +
                            " left empty");
      }
  }

  const RecipeJob& job_;
  MeasuredByRecipe measured_;
  Lenders lenders_;
  std::optional<MeasuredShape> first_;  ///< where a model is measured too
  ShapeNames names_;
  FilesOfShapes files_;
  bool template_suits_ = false;            ///< a shape has its vertices and faces
  std::shared_ptr<const Topology> faces_;  ///< of the mesh before
  bool alone_ = false;                     ///< one shape is measured
  std::map<std::string, std::map<std::string, std::vector<std::string>>>
      missing_;  ///< measurements by shape and reason
  std::vector<std::string> warnings_;
};

}  // namespace

Result<Report> measure_by_recipe(const RecipeJob& job, Progress& progress) {
  const std::string source = job.recipe.empty() ? recipe_of_template(job.the_template) : job.recipe;
  if (source.empty())
    return fail(job.the_template,
                "has no recipe beside it; give one with --recipe (" + listed(shipped_recipes(), ", ") + " or a file)");
  auto recipe = load_recipe(source);
  if (!recipe) return fail(recipe.error());
  return RecipeWork(job, std::move(*recipe)).run(progress);
}

}  // namespace homolog
