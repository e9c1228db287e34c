#include "core/model/shapes/shape_files.h"

#include <algorithm>
#include <atomic>
#include <utility>

#include "core/base/files/files.h"
#include "core/base/processes/parallel.h"
#include "core/base/text/text.h"
#include "core/model/shapes/doubtful_shapes.h"
#include "core/model/shapes/shape_folder.h"
#include "core/model/shapes/study.h"
#include "core/template/other_side.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

/// An error for a format that keeps no numbering.
Result<void> check_numbering(const fs::path& file) {
  if (!is_mesh_name(file) || keeps_numbers(file)) return {};
  return fail(file.string(), "is a " + lower_case(file.extension().string()) +
                                 " file, which does not keep vertices and so no correspondence; use PLY or VTK");
}

std::vector<std::optional<int>> frames_of(const ShapeSource& source, const ShapesOfFile& shapes, bool all_frames) {
  const ShapesOfStructure* structure = shapes.structure(source.structure);
  if (source.frame || !all_frames || structure == nullptr || structure->edited.empty()) return {source.frame};
  return {structure->edited.begin(), structure->edited.end()};
}

/// Sources that come one after the other and name one file, as the frames of a cine do.
struct OneFile {
  std::vector<const ShapeSource*> sources;
};

/// The shapes of one file, in the order of its sources, or why there is none.
struct FileRead {
  std::vector<Result<ReadShape>> shapes;
  std::vector<std::string> warnings;
};

/// Puts the other structures of a case beside one of them, those that have a mesh at the frame.
void add_others(ReadShape& shape, const ShapesOfFile& shapes, const WhichShape& which, bool flipped) {
  const auto name_of = [](const ShapesOfStructure& one) { return one.name.empty() ? one.id : one.name; };
  const ShapesOfStructure* own = shapes.structure(which.structure);
  shape.structure = name_of(*own);
  for (const ShapesOfStructure& one : shapes.structures) {
    const auto found = one.frames.find(which.frame.value_or(shapes.shown));
    if (&one == own || found == one.frames.end()) continue;
    shape.others.emplace_back(
        name_of(one), flipped ? std::make_shared<const MeshFile>(mirrored_with_names(*found->second)) : found->second);
  }
}

FileRead read_file(const OneFile& file, const ShapeReading& reading, ReadTogether& together) {
  FileRead read;
  const fs::path& path = file.sources.front()->file;
  const auto shapes = read_shapes_of(path, together);
  if (!shapes) {
    read.shapes.emplace_back(fail(shapes.error()));
    return read;
  }
  read.warnings = shapes->warnings;
  for (const ShapeSource* source : file.sources)
    for (const auto& frame : frames_of(*source, *shapes, reading.all_frames)) {
      auto mesh = shapes->shape({source->structure, frame}, path.string());
      if (!mesh) {
        read.shapes.emplace_back(fail(mesh.error()));
        continue;
      }
      ReadShape shape{source->name(frame), source, std::move(*mesh), reading.doubts ? source->doubt : std::string()};
      if (source->flipped) shape.mesh = std::make_shared<const MeshFile>(mirrored_with_names(*shape.mesh));
      add_others(shape, *shapes, {source->structure, frame}, source->flipped);
      if (reading.doubts && !source->done && source->doubt.empty()) shape.doubt = doubt_of_shape(*shape.mesh);
      read.shapes.emplace_back(std::move(shape));
    }
  return read;
}

}  // namespace

const ShapesOfStructure* ShapesOfFile::structure(std::string_view id) const {
  const auto found = std::find_if(structures.begin(), structures.end(),
                                  [&](const ShapesOfStructure& one) { return id.empty() || one.id == id; });
  return found == structures.end() ? nullptr : &*found;
}

Result<std::shared_ptr<const MeshFile>> ShapesOfFile::shape(const WhichShape& which, const std::string& name) const {
  const ShapesOfStructure* one = structure(which.structure);
  if (one == nullptr && !which.structure.empty())
    return fail(name, "has no structure \"" + which.structure + "\"; correct the study, or choose another file");
  if (one != nullptr)
    if (const auto found = one->frames.find(which.frame.value_or(shown)); found != one->frames.end())
      return found->second;
  return fail(name,
              (which.frame ? "has no mesh at frame " + std::to_string(*which.frame) : std::string("has no mesh")) +
                  " yet; place a template in it first");
}

namespace {

/// `known`: null where no other shapes are read.
ShapesOfFile shapes_sharing(const Document& document, KnownParts* known) {
  ShapesOfFile shapes;
  shapes.shown = document.frame;
  for (const auto& structure : document.structures) {
    ShapesOfStructure& of = shapes.structures.emplace_back();
    of.id = structure->id;
    of.name = structure->name;
    for (const auto& [frame, shared] : structure->shapes) {
      const Shape& shape = *shared;
      MeshFile file = to_mesh_file({*structure, shape, frame}, document.scan.frames() > 1);
      // Those that nobody placed lie where the mesh has carried them.
      for (Landmark& landmark : carried_landmarks(*structure->the_template, file.points))
        if (!shape.landmarks.contains(landmark.name)) file.landmarks.push_back(std::move(landmark));
      if (shape.confirmed) file.arrays["confirmed"] = *shape.confirmed;
      if (known != nullptr) known->share(file);
      of.frames[frame] = std::make_shared<const MeshFile>(std::move(file));
      if (shape.strokes > 0) of.edited.push_back(frame);
    }
  }
  return shapes;
}

/// The same of a file. `known`: null where nothing else is read.
Result<ShapesOfFile> read_sharing(const fs::path& file, KnownParts* known) {
  if (auto numbered = check_numbering(file); !numbered) return fail(numbered.error());
  if (is_case_file(file)) {
    ReplayOptions options;
    options.shapes_alone = true;
    auto read = read_case(file, options);
    if (!read) return fail(read.error());
    ShapesOfFile shapes = shapes_sharing(read->session.document(), known);
    shapes.warnings = std::move(read->warnings);
    return shapes;
  }
  auto mesh = read_mesh_file(file);
  if (!mesh) return fail(mesh.error());
  ShapesOfFile shapes;
  for (const std::string& warning : mesh->warnings) shapes.warnings.push_back(file.string() + ": " + warning);
  if (known != nullptr) known->share(*mesh);
  shapes.structures.push_back({{}, {{0, std::make_shared<const MeshFile>(std::move(*mesh))}}, {}});
  return shapes;
}

}  // namespace

void KnownParts::share(MeshFile& mesh) {
  constexpr std::size_t most = 16;  // templates of one study
  const std::lock_guard lock(mutex_);
  const auto take_known = [](auto& list, auto& part, const auto& is_same) {
    const auto known = std::ranges::find_if(list, [&](const auto& one) { return is_same(one, part); });
    if (known != list.end())
      part = *known;
    else if (list.size() < most)
      list.push_back(part);
  };
  take_known(triangles_, mesh.triangles, std::equal_to());
  if (mesh.stiffness)
    take_known(stiffness_, mesh.stiffness,
               [](const auto& a, const auto& b) { return a->size() == b->size() && *a == *b; });
}

ShapesOfFile shapes_of(const Document& document) {
  return shapes_sharing(document, nullptr);
}

Result<ShapesOfFile> read_shapes_of(const fs::path& file) {
  return read_sharing(file, nullptr);
}

Result<ShapesOfFile> read_shapes_of(const fs::path& file, ReadTogether& together) {
  std::unique_lock lock(together.one_image, std::defer_lock);
  if (is_case_file(file) && shapes_need_image(file)) lock.lock();
  return read_sharing(file, &together.parts);
}

Result<std::shared_ptr<const MeshFile>> read_shape(const ShapeSource& source) {
  const auto shapes = read_shapes_of(source.file);
  if (!shapes) return fail(shapes.error());
  auto mesh = shapes->shape({source.structure, source.frame}, source.file.string());
  return mesh && source.flipped ? std::make_shared<const MeshFile>(mirrored_with_names(**mesh)) : mesh;
}

ShapeSource source_of(const StudyCase& one) {
  const bool done = one.state == CaseState::done;
  return {.file = one.file,
          .frame = one.frame,
          .flipped = one.flipped,
          .doubt = done ? std::string() : one.doubt,
          .group = one.group,
          .done = done,
          .structure = one.structure,
          .study_case = one.name};
}

Result<std::vector<ShapeSource>> shape_sources(const std::vector<fs::path>& files, const std::string& group) {
  std::vector<ShapeSource> sources;
  for (const fs::path& file : files) {
    if (!is_study_file(file)) {
      if (!group.empty())
        return fail(file.string(), "belongs to no group; only the cases of a study (.study.json) have groups");
      std::error_code ignored;
      if (!fs::is_directory(file, ignored)) {
        sources.push_back({file, {}, false});
        continue;
      }
      auto shapes = shapes_in_folder(file);
      if (!shapes) return fail(shapes.error());
      for (fs::path& shape : *shapes) sources.push_back({std::move(shape), {}, false});
      continue;
    }
    const auto read = read_study(file);
    if (!read) return fail(read.error());
    const std::size_t before = sources.size();
    for (const StudyCase& one : read->study.cases) {
      if (one.waits() || !(group.empty() || one.group == group)) continue;
      sources.push_back(source_of(one));
    }
    if (sources.size() > before) continue;
    if (std::any_of(read->study.cases.begin(), read->study.cases.end(),
                    [&](const StudyCase& one) { return one.waits() && (group.empty() || one.group == group); }))
      return fail(file.string(), "has only cases that wait for their fit; fit them first");
    std::string known;
    for (const std::string& name : read->study.groups()) known += (known.empty() ? "" : ", ") + name;
    return fail(file.string(), group.empty()   ? "has no cases yet; add some first"
                               : known.empty() ? "has no groups; leave --group out"
                                               : "has no case of the group " + group + "; its groups are " + known);
  }
  return sources;
}

Result<std::vector<std::string>> read_shapes(const std::vector<ShapeSource>& sources, const ShapeReading& reading,
                                             const TakeShape& take, Progress* progress) {
  const auto may_have_frames = [](const ShapeSource& one) { return is_case_file(one.file) && !one.frame; };
  if (reading.all_frames && !sources.empty() && std::none_of(sources.begin(), sources.end(), may_have_frames))
    return fail(sources.front().file.string(),
                "gives one frame, as do all others here, so --all-frames has no effect; leave it out, or give the "
                "case files of cines");
  std::vector<OneFile> files;
  for (const ShapeSource& source : sources) {
    if (auto numbered = check_numbering(source.file); !numbered) return fail(numbered.error());
    if (files.empty() || files.back().sources.front()->file != source.file) files.emplace_back();
    files.back().sources.push_back(&source);
  }
  constexpr std::size_t at_a_time = 32;  // so that few meshes wait to be taken
  std::vector<std::string> warnings;
  std::optional<Error> unreadable;
  std::size_t taken = 0;
  ReadTogether together;
  for (std::size_t first = 0; first < files.size(); first += at_a_time) {
    std::vector<FileRead> reads(std::min(at_a_time, files.size() - first));
    std::atomic<std::size_t> done = first;
    for_each_in_parallel(reads.size(), [&](std::size_t k) {
      if (progress != nullptr && progress->cancelled()) return;
      reads[k] = read_file(files[first + k], reading, together);
      if (progress != nullptr) progress->report(static_cast<double>(++done) / static_cast<double>(files.size()));
    });
    if (progress != nullptr && progress->cancelled()) return fail("", "was stopped while the shapes were read");
    for (FileRead& read : reads) {
      warnings.insert(warnings.end(), read.warnings.begin(), read.warnings.end());
      for (Result<ReadShape>& shape : read.shapes) {
        if (!shape) {
          if (!unreadable) unreadable = shape.error();
          warnings.push_back(shape.error().sentence() + " (left out)");
          continue;
        }
        if (auto took = take(std::move(*shape)); !took) return fail(took.error());
        ++taken;
      }
    }
  }
  if (taken == 0) return fail(unreadable.value_or(Error{"", "no shape was given; a model needs at least two"}));
  return warnings;
}

Result<void> write_shapes(const std::vector<NamedShape>& shapes, const std::string& extension, const fs::path& folder,
                          Progress* progress) {
  const auto made = ResultFolder::make(folder);
  if (!made) return fail(made.error());
  double done = 0;
  for (const NamedShape& shape : shapes) {
    if (progress != nullptr) {
      progress->report(done++ / static_cast<double>(shapes.size()));
      if (progress->cancelled()) return fail("", "was stopped; the shapes written so far are kept");
    }
    if (!is_file_name(shape.name)) return fail(shape.name, "cannot be the name of a file; rename the case");
    const std::string imported = shape.imported.extension().string();
    const std::string ending = !extension.empty() ? extension : imported.empty() ? ".ply" : imported;
    const fs::path path = folder / (shape.name + ending);
    if (!shape.changed && ending == imported) {
      const auto bytes = read_whole_file(shape.imported);
      if (!bytes) return fail(bytes.error());
      if (auto copied = write_whole_file(path, *bytes); !copied) return copied;
      continue;
    }
    if (auto written = write_mesh_file(*shape.mesh, path); !written) return written;
  }
  return {};
}

}  // namespace homolog
