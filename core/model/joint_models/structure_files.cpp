#include "core/model/joint_models/structure_files.h"

#include <algorithm>
#include <map>
#include <set>
#include <string_view>

#include "core/base/files/file_stem.h"
#include "core/base/files/files.h"
#include "core/base/files/paths.h"
#include "core/base/text/listed.h"
#include "core/base/text/nearest_names.h"
#include "core/base/text/text.h"
#include "core/mesh/mesh_io.h"
#include "core/model/shapes/shape_folder.h"
#include "core/model/shapes/study.h"
#include "core/session/case_file.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view ending_of(ShapeWorksFrame frame) {
  return frame == ShapeWorksFrame::local ? "_local" : "_world";
}

/// The entries of a folder, by name; hidden things aside.
Result<std::vector<fs::path>> entries_of(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (!entry->path().filename().string().starts_with('.')) found.push_back(entry->path());
  if (error) return fail(folder.string(), "cannot be read: " + error.message() + "; name a folder of cases");
  std::sort(found.begin(), found.end());
  return found;
}

/// Without a slash at its end, and with the folder's name where that is ".".
fs::path whole_path(const fs::path& path) {
  fs::path whole = absolute_path(path).lexically_normal();
  return whole.has_filename() ? whole : whole.parent_path();
}

/// The case file of which a folder holds the meshes.
fs::path case_beside(const fs::path& folder) {
  fs::path file = folder;
  file += ".homolog";
  return file;
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
    const fs::path whole = whole_path(folder);
    if (std::error_code none;
        !of_shapeworks && fs::exists(case_beside(whole), none) && goes_on_after_fit(case_beside(whole)))
      worked_on.push_back(case_beside(whole));
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
      if (auto added = add_case(file_stem(file), {.file = file}); !added) return added;
    return {};
  }

  /// The structures that a case file holds, in place of all meshes of that case. `of`: which frame of it, and what a
  /// study says; where it names a structure, that one alone is taken.
  Result<void> add_case(const std::string& name, const ShapeSource& of) {
    // A study names a file once for each of its frames or structures.
    if (of.file != read_file_) {
      auto read = read_shapes_of(of.file);
      if (!read) return fail(read.error());
      read_file_ = of.file;
      read_ = std::move(*read);
    }
    const fs::path meshes = whole_path(of.file).parent_path() / file_stem(of.file);
    if (by_cases_.insert(meshes).second) forget(meshes);
    std::vector<ShapeSource>& files = files_of(name);
    for (const ShapesOfStructure& one : read_.structures) {
      others_.insert(one.name);
      const auto found = std::find(structures_.begin(), structures_.end(), lower_case(one.name));
      if (found == structures_.end() || one.frames.empty()) continue;
      if (!of.structure.empty() && of.structure != one.id) continue;
      ShapeSource& there = files[found - structures_.begin()];
      if (!there.file.empty() && whole_path(there.file) != whole_path(of.file))
        return fail(of.file.string(), "has the name of " + there.file.string() + "; rename one of the cases");
      there = of;
      there.structure = one.id;
    }
    return {};
  }

  /// The cases of a study as it says: their frames, flipped ones, doubts. Those that wait for their fit are left out.
  Result<void> add_study(const fs::path& file) {
    const auto read = read_study(file);
    if (!read) return fail(read.error());
    std::map<fs::path, std::set<std::optional<int>>> frames;
    for (const StudyCase& one : read->study.cases)
      if (!one.waits()) frames[one.file].insert(one.frame);
    if (frames.empty()) return fail(file.string(), "has no case that is fitted; fit its cases first");
    for (const StudyCase& one : read->study.cases) {
      if (one.waits()) continue;
      if (!is_case_file(one.file))
        return fail(file.string(), "has " + one.name +
                                       " as a mesh, which holds one structure; name the folder of the structures' "
                                       "meshes in place of the study");
      const bool is_whole = one.structure.empty();  // else it is named after its structure too
      const std::string name = is_whole || frames[one.file].size() > 1 ? one.name : file_stem(one.file);
      if (auto added = add_case(name, source_of(one)); !added) return added;
    }
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
    if (by_cases_.contains(whole_path(file).parent_path())) return {};
    others_.insert(structure);
    const auto found = std::find(structures_.begin(), structures_.end(), lower_case(structure));
    if (found == structures_.end()) return {};
    fs::path& there = files_of(case_name)[found - structures_.begin()].file;
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

  /// The meshes of a folder count no more.
  void forget(const fs::path& meshes) {
    for (auto& [name, files] : cases_)
      for (ShapeSource& there : files)
        if (there.structure.empty() && whole_path(there.file).parent_path() == meshes) there = {};
    std::erase_if(cases_, [](const auto& one) {
      return std::ranges::all_of(one.second, [](const ShapeSource& there) { return there.file.empty(); });
    });
  }

  std::vector<ShapeSource>& files_of(const std::string& case_name) {
    return cases_.try_emplace(case_name, structures_.size()).first->second;
  }

  std::vector<std::string> structures_;  ///< in lower case
  ShapeWorksFrame frame_;
  std::map<std::string, std::vector<ShapeSource>> cases_;
  std::set<std::string> others_;  ///< names of all structures that are there
  fs::path read_file_;            ///< the case that was read last
  ShapesOfFile read_;             ///< the content of that case
  std::set<fs::path> by_cases_;   ///< folders of meshes whose case file is taken in their place
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
    auto added = is_study_file(file)  ? finder.add_study(file)
                 : is_case_file(file) ? finder.add_case(file_stem(file), {.file = file})
                                      : finder.add(file);
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
    const std::string& name = names[s];
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
