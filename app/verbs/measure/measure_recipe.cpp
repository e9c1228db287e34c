#include "app/verbs/measure/measure_recipe.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <optional>
#include <set>

#include "app/verbs/case_landmarks.h"
#include "app/verbs/read_image.h"
#include "core/base/files/files.h"
#include "core/base/text/listed.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/files/landmark_io.h"
#include "core/mesh/files/mesh_frame.h"
#include "core/mesh/repair/inside_out.h"
#include "core/model/files/model_files.h"
#include "core/model/files/statismo.h"
#include "core/model/joint_models/structure_files.h"
#include "core/model/measures/sizes.h"
#include "core/model/shapes/recipe_shapes.h"

namespace homolog {

namespace {

/// One shape, measured.
struct MeasuredCase {
  std::string name;
  std::string file;   ///< as OfCase has it
  std::string group;  ///< of a study's case; empty: none
  std::optional<int> frame;
  std::vector<MeasuredNumber> values;
};

/// Which shape is measured.
struct OfCase {
  std::string file;                ///< as ReadShape names it
  std::vector<std::string> stems;  ///< what files of its own may be called
  std::string group;
  std::optional<int> frame{};
  std::filesystem::path source{};  ///< the file that it was read from, or the folder of several
};

/// Measures shapes one after the other, as they are read.
class RecipeWork {
 public:
  RecipeWork(const RecipeJob& job, Recipe recipe) : job_(job), recipe_(std::move(recipe)) {}

  Result<Report> run(Progress& progress) {
    if (!job_.the_template.empty()) {
      auto lender = load_template(job_.the_template);
      if (!lender) return fail(lender.error());
      lenders_.add(std::move(*lender));
    }
    progress.part(0, job_.model.empty() ? 1 : 0.8);
    if (auto read = read_all(progress); !read) return fail(read.error());
    name_cases();
    for (const MeasuredCase& one : cases_) note_missing(one.name, one.values);
    if (!job_.model.empty()) {
      progress.part(0.8, 1);
      if (auto along = measure_model(progress); !along) return fail(along.error());
    }
    say_missing();
    return report();
  }

 private:
  /// Folders of cases with a mesh for each structure, where the recipe names structures; all else as shapes.
  Result<void> read_all(Progress& progress) {
    const std::vector<std::string> structures = recipe_.structures();
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
      if (auto placed = add_landmarks(of, shape.structures.front()); !placed) return placed;
    if (auto seen = add_image(of, name, shape); !seen) return seen;
    template_suits_ = lenders_.lend_to(shape) || template_suits_;
    if (!job_.model.empty() && cases_.empty()) first_ = shape;
    cases_.push_back({name, of.file, of.group, of.frame, measure(recipe_, shape)});
    return job_.profiles.empty() ? Result<void>() : write_profiles(name, shape);
  }

  /// Gives the cases the names that tables have, of equal ones with their folders.
  void name_cases() {
    std::vector<std::string> files;
    for (const MeasuredCase& one : cases_) files.push_back(one.file);
    const auto names = names_with_folders(files);
    for (std::size_t k = 0; k < cases_.size(); ++k) cases_[k].name = names[k];
  }

  /// The folder of a shape's own folder's name in one that holds files of shapes, and then that one.
  static std::vector<std::filesystem::path> folders_for(const OfCase& of, const std::filesystem::path& folder) {
    std::error_code ignored;
    const auto own = folder / std::filesystem::absolute(of.source, ignored).parent_path().filename();
    if (of.source.empty() || !std::filesystem::is_directory(own, ignored)) return {folder};
    return {own, folder};
  }

  /// Remembers of which shape a file is; gives another one that it was taken for.
  static std::optional<std::filesystem::path> taken_for(const OfCase& of, const std::filesystem::path& file,
                                                        std::map<std::filesystem::path, std::filesystem::path>& taken) {
    const auto& first = taken.emplace(file, of.source).first->second;
    return first == of.source ? std::nullopt : std::optional(first);
  }

  /// The image of one of these names in a folder; of several the last. Empty: there is none.
  static std::filesystem::path image_in(const std::filesystem::path& folder, const std::vector<std::string>& stems) {
    std::filesystem::path file;
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(folder, ignored))
      if (std::ranges::count(stems, case_name_of(entry.path())) > 0 && looks_like_volume(entry.path()))
        file = std::max(file, entry.path());
    return file;
  }

  /// The image that is sampled along normals: one for all, or of the shape's name.
  Result<void> add_image(const OfCase& of, const std::string& name, MeasuredShape& shape) {
    if (job_.image.empty()) return {};
    const int frame = of.frame.value_or(0);
    std::filesystem::path file = job_.image;
    std::error_code ignored;
    if (std::filesystem::is_directory(file, ignored)) {
      file.clear();
      for (const auto& folder : folders_for(of, job_.image))
        if (file.empty()) file = image_in(folder, of.stems);
      if (file.empty()) {
        warnings_.push_back(name + ": has no image in " + job_.image.string() + " (" + listed(of.stems, " or ") +
                            ".nii.gz); call it so");
        return {};
      }
      if (const auto other = taken_for(of, file, images_taken_))
        warnings_.push_back(file.string() + ": is sampled for " + other->string() + " and for " + of.source.string() +
                            "; if it is not the image of both, put each image into a folder of its shape's folder's "
                            "name");
    }
    if (file != image_file_) {
      Progress unseen;
      auto read = read_image(file, frame, unseen);
      if (!read) return fail(read.error());
      image_ = std::move(read->volume);
      image_file_ = file;
    }
    if (frame >= image_.frames) return fail(file.string(), "has no frame " + std::to_string(frame));
    shape.image = &image_;
    shape.frame = frame;
    return {};
  }

  /// The first structure of a shape with the image along its normals, an array for each offset and one of their mean.
  Result<void> write_profiles(const std::string& name, const MeasuredShape& shape) {
    const MeasuredStructure& structure = shape.structures.front();
    if (shape.image == nullptr || structure.mesh.topology == nullptr) return {};
    MeshFile file;
    file.points = structure.mesh.points;
    file.triangles = structure.mesh.topology;
    for (const std::size_t k : recipe_.measurements) {
      const RecipeStep& step = recipe_.steps[k];
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
        std::snprintf(offset, sizeof offset, " at %+.2f mm", profile.offsets_mm[static_cast<std::size_t>(at)]);
        file.values[step.name + offset] = profile.values.col(at);
      }
    }
    if (file.values.empty())
      return fail("--profiles", "has no effect here: the recipe has no measurement of the kind image_mean");
    if (auto made = make_folder(job_.profiles); !made) return made;
    return write_mesh_file(file, job_.profiles / (name + ".vtp"));
  }

  /// Landmarks that lie in files of their own; they count before those of the mesh.
  Result<void> add_landmarks(const OfCase& of, MeasuredStructure& structure) {
    if (job_.landmarks.empty()) return {};
    std::filesystem::path file = job_.landmarks;
    std::error_code ignored;
    if (std::filesystem::is_directory(file, ignored)) {
      file.clear();
      for (const auto& folder : folders_for(of, job_.landmarks))
        for (const std::string& stem : of.stems)
          if (file.empty()) file = landmark_file_in(folder, stem);
      if (const auto other = file.empty() ? std::nullopt : taken_for(of, file, landmarks_taken_))
        return fail(file.string(), "may be of " + other->string() + " or of " + of.source.string() +
                                       "; put each shape's landmarks into a folder of its folder's name");
    } else if (!alone_)
      return fail(file.string(), "is one file for several shapes; give the folder with a file of each shape's name");
    if (file.empty()) return {};
    auto read = read_landmarks(file);
    if (!read) return fail(read.error());
    for (const Landmark& placed : *read)
      std::erase_if(structure.landmarks, [&](const Landmark& own) { return own.name == placed.name; });
    structure.landmarks.insert(structure.landmarks.end(), read->begin(), read->end());
    return {};
  }

  Result<void> measure_model(Progress& progress) {
    const auto model = read_model(job_.model);
    if (!model) return fail(model.error());
    const int there = static_cast<int>(model->modes());
    if (job_.modes > there)
      warnings_.push_back(job_.model.string() + ": has " + std::to_string(there) + " modes, so these are measured");
    Lenders lenders = lenders_;
    if (first_) lenders.add(*first_);  // the model's shapes have no landmarks of their own
    auto along = measure_modes(recipe_, *model, std::min(job_.modes, there), lenders, progress);
    if (!along) return fail(along.error());
    modes_ = std::move(*along);
    if (!modes_.empty()) note_missing("the model", modes_.front().values);
    return {};
  }

  /// Remembers why a shape lacks measurements, by the reason.
  void note_missing(const std::string& name, const std::vector<MeasuredNumber>& values) {
    for (std::size_t k = 0; k < values.size(); ++k) {
      const RecipeStep& step = recipe_.steps[recipe_.measurements[k]];
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
    const std::size_t all = cases_.size() + (modes_.empty() ? 0 : 1);
    for (const auto& [name, reasons] : missing_)
      for (const auto& [reason, measurements] : reasons) {
        const bool of_all = all > 1 && shapes_without[reason] == all;
        if (of_all && !said.insert(reason).second) continue;
        warnings_.push_back((of_all ? std::string("every shape") : name) + ": " + reason + ", so " +
                            listed(measurements, " and ") + (measurements.size() == 1 ? " is" : " are") +
                            " left empty");
      }
  }

  Json values_of(const std::vector<MeasuredNumber>& values) const {
    Json by_name = Json::object();
    for (std::size_t k = 0; k < values.size(); ++k)
      by_name[recipe_.steps[recipe_.measurements[k]].name] = values[k].value ? Json(*values[k].value) : Json();
    return by_name;
  }

  Result<Report> report() {
    Json measurements = Json::array(), cases = Json::array(), modes = Json::array();
    for (std::size_t k = 0; k < recipe_.measurements.size(); ++k) {
      std::vector<std::optional<double>> values;
      for (const MeasuredCase& one : cases_) values.push_back(one.values[k].value);
      const Spread spread = spread_of(values);
      const RecipeStep& step = recipe_.steps[recipe_.measurements[k]];
      Json row{{"name", step.name}, {"unit", step.unit}, {"kind", kind_word(step)}, {"count", spread.count}};
      row["mean"] = spread.count > 0 ? Json(spread.mean) : Json();
      row["sd"] = spread.count > 0 ? Json(spread.sd) : Json();
      measurements.push_back(std::move(row));
    }
    for (const MeasuredCase& one : cases_) {
      Json row{{"name", one.name}};
      if (one.frame) row["frame"] = *one.frame;
      if (!one.group.empty()) row["group"] = one.group;
      row["values"] = values_of(one.values);
      cases.push_back(std::move(row));
    }
    for (const ModeValues& one : modes_)
      modes.push_back({{"mode", one.mode}, {"sd", one.sd}, {"values", values_of(one.values)}});
    Report report;
    report.warnings = std::move(warnings_);
    report.values = {{"recipe", recipe_.name}, {"measurements", std::move(measurements)}, {"cases", std::move(cases)}};
    if (!job_.model.empty()) report.values["modes"] = std::move(modes);
    if (!job_.profiles.empty()) report.values["profiles"] = job_.profiles.string();
    if (job_.out.empty()) return report;
    if (auto written = write_whole_file(job_.out, table()); !written) return fail(written.error());
    report.values["table"] = job_.out.string();
    report.made = {job_.out};
    return report;
  }

  std::string table() const {
    const auto any = [&](const auto& has) { return std::ranges::any_of(cases_, has); };
    const bool frames = any([](const MeasuredCase& one) { return one.frame.has_value(); });
    const bool groups = any([](const MeasuredCase& one) { return !one.group.empty(); });
    std::string text = "name";
    for (const auto& [there, column] : {std::pair(frames, ",frame"), {groups, ",group"}, {!modes_.empty(), ",mode,sd"}})
      if (there) text += column;
    text += measurement_columns(recipe_) + '\n';
    for (const MeasuredCase& one : cases_) {
      text += csv_field(one.name);
      if (frames) text += ',' + (one.frame ? std::to_string(*one.frame) : "");
      if (groups) text += ',' + csv_field(one.group);
      if (!modes_.empty()) text += ",,";
      text += measurement_cells(one.values) + '\n';
    }
    for (const ModeValues& one : modes_) {
      text += std::string("model") + (frames ? "," : "") + (groups ? "," : "");
      text += ',' + std::to_string(one.mode) + ',' + std::to_string(static_cast<int>(one.sd));
      text += measurement_cells(one.values) + '\n';
    }
    return text;
  }

  const RecipeJob& job_;
  Recipe recipe_;
  Lenders lenders_;
  std::optional<MeasuredShape> first_;  ///< where a model is measured too
  ShapeNames names_;
  std::map<std::filesystem::path, std::filesystem::path> landmarks_taken_, images_taken_;  ///< the shape by the file
  bool template_suits_ = false;            ///< a shape has its vertices and faces
  std::shared_ptr<const Topology> faces_;  ///< of the mesh before
  Volume image_;                           ///< of `image_file_`
  std::filesystem::path image_file_;
  bool alone_ = false;  ///< one shape is measured
  std::vector<MeasuredCase> cases_;
  std::vector<ModeValues> modes_;
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
