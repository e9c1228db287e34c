#include "core/model/files/model_files.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/base/files/file_stem.h"
#include "core/base/files/files.h"
#include "core/mesh/formats/text.h"
#include "core/mesh/mesh_io.h"
#include "core/session/case_file.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

template <class Values>
void append_row(const Values& values, std::string& text) {
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    if (k > 0) text += ',';
    formats::append_number(values[k], text);
  }
  text += '\n';
}

std::string mean_table(const PrincipalComponents& components) {
  std::string text = "x,y,z\n";
  const Points mean = points_of(components.mean);
  for (Eigen::Index v = 0; v < mean.rows(); ++v) append_row(Vec3(mean.row(v)), text);
  return text;
}

std::string variance_table(const PrincipalComponents& components) {
  std::string text = "mode,variance_mm2,share,cumulative_share\n";
  const Eigen::VectorXd variances = components.variances();
  const double total = components.total_variance();
  double held = 0;
  for (Eigen::Index k = 0; k < variances.size(); ++k) {
    held += variances[k];
    append_row(Eigen::Vector4d(static_cast<double>(k + 1), variances[k], variances[k] / total, held / total), text);
  }
  return text;
}

std::string score_table(const PrincipalComponents& components, const std::vector<std::string>& names,
                        const std::vector<double>& sizes_mm, const std::vector<std::string>& groups) {
  const Eigen::MatrixXd scores = components.scores();
  std::string text = "shape";
  for (Eigen::Index k = 0; k < scores.rows(); ++k) text += ",b" + std::to_string(k + 1);
  if (!sizes_mm.empty()) text += ",centroid_size_mm";
  text += groups.empty() ? "\n" : ",group\n";
  for (Eigen::Index i = 0; i < scores.cols(); ++i) {
    text += csv_field(names[i]) + ',';
    append_row(scores.col(i), text);
    const auto shape = static_cast<std::size_t>(i);
    text.pop_back();  // the line goes on
    if (!sizes_mm.empty()) {
      text += ',';
      formats::append_number(sizes_mm[shape], text);
    }
    if (!groups.empty()) text += ',' + csv_field(groups[shape]);
    text += '\n';
  }
  return text;
}

/// The last `count` folders of a path.
fs::path innermost(fs::path folder, std::size_t count) {
  fs::path end;
  for (; count > 0 && folder.has_filename(); --count, folder = folder.parent_path())
    end = end.empty() ? folder.filename() : folder.filename() / end;
  return end;
}

}  // namespace

std::string shape_stem(const std::string& file) {
  // "heart.homolog structure s2 frame 7" is the shape "heart structure s2 frame 7".
  std::size_t which = file.rfind(" structure ");
  if (which == std::string::npos || !is_case_file(file.substr(0, which))) which = file.rfind(" frame ");
  const bool is_of_case = which != std::string::npos && is_case_file(file.substr(0, which));
  return is_of_case ? file_stem(file.substr(0, which)) + file.substr(which) : file_stem(file);
}

std::string ShapeNames::next(const std::string& file) {
  return next_of(shape_stem(file));
}

std::string ShapeNames::next_of(const std::string& stem) {
  std::string name = stem;
  while (used_.contains(name)) name = stem + "-" + std::to_string(++used_[stem]);
  used_[name] = 1;
  return name;
}

std::vector<std::string> names_with_folders(const std::vector<std::string>& files) {
  std::map<std::string, std::set<fs::path>> folders;  // by the stem of the files
  const auto folder_of = [](const std::string& file) {
    std::error_code ignored;
    return fs::absolute(file, ignored).lexically_normal().parent_path();
  };
  for (const std::string& file : files) folders[shape_stem(file)].insert(folder_of(file));
  std::map<std::string, std::size_t> depth;
  for (const auto& [stem, of_stem] : folders) {
    const auto differ = [&all = of_stem](std::size_t count) {
      std::set<fs::path> ends;
      for (const fs::path& folder : all) ends.insert(innermost(folder, count));
      return ends.size() == all.size();
    };
    while (!differ(depth[stem])) ++depth[stem];
  }
  ShapeNames names;
  std::vector<std::string> named;
  for (const std::string& file : files) {
    const std::string stem = shape_stem(file);
    named.push_back(names.next_of((innermost(folder_of(file), depth[stem]) / stem).generic_string()));
  }
  return named;
}

std::vector<std::string> shape_names(const std::vector<std::string>& files) {
  ShapeNames all;
  std::vector<std::string> names;
  for (std::string name : names_with_folders(files)) {
    std::ranges::replace(name, '/', '-');
    names.push_back(all.next_of(name));
  }
  return names;
}

Result<void> write_model_tables(const PrincipalComponents& components, const std::vector<std::string>& names,
                                const fs::path& folder, const std::vector<double>& sizes_mm,
                                const std::vector<std::string>& groups) {
  const auto made = ResultFolder::make(folder);
  if (!made) return fail(made.error());
  if (auto done = write_whole_file(folder / "mean.csv", mean_table(components)); !done) return done;
  if (auto done = write_whole_file(folder / "variances.csv", variance_table(components)); !done) return done;
  return write_whole_file(folder / "scores.csv", score_table(components, names, sizes_mm, groups));
}

Result<void> write_pose_table(const StructurePoses& poses, const std::vector<StructurePart>& parts,
                              const std::vector<std::string>& names, const std::vector<CompletedStructure>& completed,
                              const fs::path& folder) {
  const auto made = ResultFolder::make(folder);
  if (!made) return fail(made.error());
  std::string text =
      "shape,structure,offset_x_mm,offset_y_mm,offset_z_mm,turn_x_deg,turn_y_deg,turn_z_deg,scale,completed\n";
  for (Eigen::Index s = 0; s < poses.values.cols(); ++s)
    for (Eigen::Index k = 0; k < std::ssize(parts); ++k) {
      const bool is_completed = std::any_of(completed.begin(), completed.end(), [&](const CompletedStructure& one) {
        return one.shape == s && one.part == k;
      });
      text += csv_field(names[s]) + ',' + csv_field(parts[k].name) + ',';
      Eigen::VectorXd row(StructurePoses::numbers + 1);
      row << poses.values.block(StructurePoses::numbers * k, s, StructurePoses::numbers, 1), is_completed ? 1 : 0;
      row[6] = std::exp(row[6]);
      append_row(row, text);
    }
  return write_whole_file(folder / "poses.csv", text);
}

Result<void> write_aligned_shapes(const PrincipalComponents& components,
                                  const std::shared_ptr<const Topology>& topology,
                                  const std::vector<std::string>& names, const fs::path& folder) {
  const auto made = ResultFolder::make(folder);
  if (!made) return fail(made.error());
  MeshFile file;
  file.triangles = topology;
  for (Eigen::Index i = 0; i < components.shapes(); ++i) {
    const Eigen::VectorXd shape = components.mean + components.centred.col(i);
    file.points = points_of(shape);
    const std::string& name = names[i];
    if (auto done = write_mesh_file(file, folder / (name + ".particles")); !done) return done;
    if (!topology) continue;
    if (auto done = write_mesh_file(file, folder / (name + ".ply")); !done) return done;
  }
  return {};
}

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

}  // namespace homolog
