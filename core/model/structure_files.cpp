#include "core/model/structure_files.h"

#include <algorithm>
#include <map>
#include <set>
#include <string_view>

#include "core/base/file_stem.h"
#include "core/base/files.h"
#include "core/base/listed.h"
#include "core/base/nearest_names.h"
#include "core/base/text.h"
#include "core/mesh/mesh_io.h"
#include "core/model/shape_folder.h"
#include "core/model/study.h"
#include "core/session/case_file.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view ending_of(ShapeWorksFrame frame) {
  return frame == ShapeWorksFrame::local ? "_local" : "_world";
}

/// What lies in a folder, by name; hidden things aside.
Result<std::vector<fs::path>> entries_of(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (!entry->path().filename().string().starts_with('.')) found.push_back(entry->path());
  if (error) return fail(folder.string(), "cannot be read: " + error.message() + "; name a folder of cases");
  std::sort(found.begin(), found.end());
  return found;
}

/// Collects the files of structures, and the names of all others.
class Finder {
 public:
  Finder(const std::vector<std::string>& structures, ShapeWorksFrame frame) : frame_(frame) {
    for (const std::string& name : structures) structures_.push_back(lower_case(name));
  }

  /// A folder of cases, a case, or ShapeWorks' folder.
  Result<void> add(const fs::path& folder) {
    const auto entries = entries_of(folder);
    if (!entries) return fail(entries.error());
    const auto holds = [&](ShapeWorksFrame frame) {
      return std::any_of(entries->begin(), entries->end(), [&](const fs::path& file) {
        return file.extension() == ".particles" && file_stem(file).ends_with(ending_of(frame));
      });
    };
    const bool of_shapeworks = holds(frame_);
    if (!of_shapeworks && frame_ == ShapeWorksFrame::world)
      return fail(folder.string(), "holds no _world.particles of ShapeWorks; leave --world out");
    if (!of_shapeworks && holds(ShapeWorksFrame::world))
      return fail(folder.string(), "holds _world.particles but no _local.particles; use --world");
    std::vector<fs::path> worked_on;
    const fs::path whole = folder.has_filename() ? folder : folder.parent_path();
    for (const fs::path& entry : *entries) {
      std::error_code ignored;
      if (is_case_file(entry)) {
        const bool has_meshes = fs::is_directory(folder / file_stem(entry), ignored);
        if (!of_shapeworks && (!has_meshes || goes_on_after_fit(entry))) worked_on.push_back(entry);
      } else if (fs::is_directory(entry, ignored)) {
        if (of_shapeworks) continue;
        const auto files = entries_of(entry);
        if (!files) return fail(files.error());
        for (const fs::path& file : *files)
          if (auto added = add_file(entry.filename().string(), file_stem(file), file); !added) return added;
      } else if (of_shapeworks) {
        if (auto added = add_particles(entry); !added) return added;
      } else if (auto added = add_file(whole.filename().string(), file_stem(entry), entry); !added) {
        return added;
      }
    }
    for (const fs::path& file : worked_on)
      if (auto added = add_case(file); !added) return added;
    return {};
  }

  /// The structures that a case file holds, in place of meshes of that case.
  Result<void> add_case(const fs::path& file) {
    const auto shapes = read_shapes_of(file);
    if (!shapes) return fail(shapes.error());
    for (const ShapesOfStructure& one : shapes->structures) {
      others_.insert(one.name);
      const auto found = std::find(structures_.begin(), structures_.end(), lower_case(one.name));
      if (found == structures_.end() || one.frames.empty()) continue;
      ShapeSource& there = files_of(file_stem(file))[static_cast<std::size_t>(found - structures_.begin())];
      if (!there.structure.empty() && there.file != file)
        return fail(file.string(), "has the name of " + there.file.string() + "; rename one of the cases");
      there = {file, {}, false};
      there.structure = one.id;
    }
    return {};
  }

  Result<void> add_study(const fs::path& file) {
    const auto read = read_study(file);
    if (!read) return fail(read.error());
    std::set<fs::path> files;
    for (const StudyCase& one : read->study.cases)
      if (is_case_file(one.file) && files.insert(one.file).second)
        if (auto added = add_case(one.file); !added) return added;
    if (files.empty()) return fail(file.string(), "has no case file; name the folder of its meshes");
    return {};
  }

  /// Errors: a structure that no case has.
  Result<void> check(const std::string& folder, const std::vector<std::string>& structures) const {
    for (std::size_t k = 0; k < structures.size(); ++k) {
      if (std::any_of(cases_.begin(), cases_.end(), [&](const auto& one) { return !one.second[k].file.empty(); }))
        continue;
      std::vector<std::string> others(others_.begin(), others_.end());
      if (others.empty())
        return fail(folder, "has no case with a mesh of " + structures[k] +
                                "; name the folder that `fit SET` wrote, which "
                                "holds CASE/" +
                                structures[k] + ".ply");
      return fail(folder, "holds no case with " + structures[k] + "; the nearest names there are " +
                              listed(nearest_names(structures[k], std::move(others), 3), " and "));
    }
    return {};
  }

  std::vector<CaseFiles> cases() {
    std::vector<CaseFiles> all;
    for (auto& [name, files] : cases_) all.push_back({name, std::move(files)});
    return all;
  }

 private:
  Result<void> add_file(const std::string& case_name, const std::string& structure, const fs::path& file) {
    if (!keeps_numbers(file)) return {};
    others_.insert(structure);
    const auto found = std::find(structures_.begin(), structures_.end(), lower_case(structure));
    if (found == structures_.end()) return {};
    fs::path& there = files_of(case_name)[static_cast<std::size_t>(found - structures_.begin())].file;
    if (!there.empty() && there.parent_path() != file.parent_path())
      return fail(file.string(),
                  "is of case " + case_name + " as " + there.string() + " is; rename one of the folders");
    if (there.empty() || file.extension() == ".ply") there = file;  // it keeps most
    return {};
  }

  /// SUBJECT_DOMAIN_local.particles. Where several structures end the name, the longest is meant.
  Result<void> add_particles(const fs::path& file) {
    std::string name = file_stem(file);
    if (file.extension() != ".particles" || !name.ends_with(ending_of(frame_))) return {};
    name.resize(name.size() - ending_of(frame_).size());
    std::string longest;
    for (std::size_t at = name.find('_'); at != std::string::npos; at = name.find('_', at + 1)) {
      const std::string domain = name.substr(at + 1);
      others_.insert(domain);
      if (longest.empty() && std::count(structures_.begin(), structures_.end(), lower_case(domain)) > 0)
        longest = domain;
    }
    if (longest.empty()) return {};
    return add_file(name.substr(0, name.size() - longest.size() - 1), longest, file);
  }

  std::vector<ShapeSource>& files_of(const std::string& case_name) {
    return cases_.try_emplace(case_name, structures_.size()).first->second;
  }

  std::vector<std::string> structures_;  ///< in lower case
  ShapeWorksFrame frame_;
  std::map<std::string, std::vector<ShapeSource>> cases_;
  std::set<std::string> others_;  ///< names of all structures that are there
};

}  // namespace

Result<std::vector<CaseFiles>> structure_files(const std::vector<fs::path>& files,
                                               const std::vector<std::string>& structures, ShapeWorksFrame frame,
                                               std::size_t least) {
  if (structures.size() < least)
    return fail("--structures", "names one structure only; name two or more, as A,B, or give that one's meshes");
  std::set<std::string> seen;
  for (const std::string& name : structures)
    if (!seen.insert(lower_case(name)).second)
      return fail("--structures", "names " + name + " twice; name each structure once");
  Finder finder(structures, frame);
  for (const fs::path& file : files) {
    const bool is_study = file.string().ends_with(".study.json");
    auto added = is_study ? finder.add_study(file) : is_case_file(file) ? finder.add_case(file) : finder.add(file);
    if (!added) return fail(added.error());
  }
  if (auto all = finder.check(files.front().string(), structures); !all) return fail(all.error());
  return finder.cases();
}

Result<void> write_structures(const ShapeMatrix& local, const ShapeMatrix& world, const Triangles& triangles,
                              const std::vector<StructurePart>& parts, const std::vector<std::string>& names,
                              const fs::path& folder) {
  const auto made = ResultFolder::make(folder);
  if (!made) return fail(made.error());
  for (Eigen::Index s = 0; s < world.cols(); ++s) {
    const std::string& name = names[static_cast<std::size_t>(s)];
    for (const StructurePart& part : parts) {
      if (!is_file_name(name) || !is_file_name(part.name))
        return fail(name + "_" + part.name, "cannot be the name of a file; rename the case or the structure");
      for (const ShapeWorksFrame frame : {ShapeWorksFrame::local, ShapeWorksFrame::world}) {
        const ShapeMatrix& shapes = frame == ShapeWorksFrame::local ? local : world;
        MeshFile file;
        file.points = points_of(shapes, s).middleRows(part.first_vertex, part.vertices);
        const std::string stem = name + "_" + part.name + std::string(ending_of(frame));
        if (auto done = write_mesh_file(file, folder / (stem + ".particles")); !done) return done;
        if (frame == ShapeWorksFrame::local || part.triangles == 0) continue;
        file.triangles = triangles_of(part, triangles);
        if (auto there = make_folder(folder / name); !there) return there;
        if (auto done = write_mesh_file(file, folder / name / (part.name + ".ply")); !done) return done;
      }
    }
  }
  return {};
}

}  // namespace homolog
