#include <algorithm>

#include "app/verbs/set/set_making.h"
#include "core/base/files/file_record.h"
#include "core/base/files/paths.h"
#include "core/base/text/listed.h"
#include "core/catalogue/catalogue.h"

// The files of a template set: what they may replace, their writing, what is left over.

namespace homolog {

namespace fs = std::filesystem;

namespace {

constexpr double near_mm = 5;  ///< structures whose surfaces come nearer are neighbours

bool is_same_file(const fs::path& a, const fs::path& b) {
  std::error_code not_there;
  return a == b || fs::equivalent(a, b, not_there);
}

/// The templates that the set has which is there already under the name that is to be written.
std::vector<fs::path> templates_of_old_set(const SetJob& job) {
  std::vector<fs::path> files;
  if (const auto old = read_template_set(job.out))
    for (const TemplateOfSet& one : old->structures)
      if (names_file(one.file.string())) files.push_back(absolute_path(one.file));
  return files;
}

/// Whether the same command made a file before, and was stopped before it wrote its set.
bool is_of_same_command(const SetJob& job, const fs::path& file, Progress& progress) {
  const auto there = read_record(file);
  if (!there || !*there) return false;
  const auto record = record_of(job.command, progress);
  return record && **there == record_of_made(*record, job.out, file);
}

/// Errors: a file that is to be written is there, and is no template of the old set.
Result<void> check_own(const SetJob& job, const std::vector<fs::path>& to_write, Progress& progress) {
  const auto own = templates_of_old_set(job);
  for (const fs::path& file : to_write) {
    std::error_code ignored;
    if (!fs::exists(fs::symlink_status(file, ignored))) continue;
    if (std::ranges::none_of(own, [&](const fs::path& one) { return is_same_file(one, file); }) &&
        !is_of_same_command(job, file, progress))
      return fail(file.string(), "is there, is no template of " + job.out.string() +
                                     ", and would be written over; move it away, or give the set another name");
  }
  return {};
}

/// Files of one run that were not there before: gone again, unless the run keeps them in the end.
struct FilesOfRun {
  std::vector<fs::path> files;

  FilesOfRun() = default;
  FilesOfRun(const FilesOfRun&) = delete;
  FilesOfRun& operator=(const FilesOfRun&) = delete;
  ~FilesOfRun() {
    std::error_code ignored;
    for (const fs::path& file : files) fs::remove(file, ignored);
  }
};

/// Names the templates in the set's folder that only the old set had. They stay: cases and other sets may need them.
void name_left_over(const SetJob& job, const std::vector<fs::path>& old_files, const TemplateSet& set,
                    std::vector<std::string>& warnings) {
  const fs::path folder = absolute_path(job.folder() / "x").parent_path();
  std::vector<std::string> left;
  for (const fs::path& file : old_files) {
    const bool is_used = std::ranges::any_of(
        set.structures, [&](const TemplateOfSet& one) { return is_same_file(absolute_path(one.file), file); });
    if (!is_used && file.parent_path() == folder && fs::exists(file)) left.push_back(file.filename().string());
  }
  if (!left.empty())
    warnings.push_back(job.folder().string() + ": holds " + some_of(left) +
                       ", which only the set before had; delete them if no case and no other set has them");
}

}  // namespace

fs::path SetJob::folder() const {
  const std::string name = out.filename().string();
  return out.parent_path() / name.substr(0, name.size() - std::string_view(".set.json").size());
}

fs::path file_of_template(const SetJob& job, const std::string& structure) {
  return absolute_path(job.folder() / (file_name_of_structure(structure) + ".ply"));
}

Result<void> check_templates_free(const SetJob& job, const std::vector<std::vector<Segment>>& asked,
                                  const TemplateSet& known, Progress& progress) {
  std::vector<fs::path> to_write;
  for (const auto& segments : asked)
    for (const Segment& segment : segments)
      if (const std::string name = name_in_set(segment); known.find(name) == nullptr)
        to_write.push_back(file_of_template(job, name));
  return check_own(job, to_write, progress);
}

Result<Report> write_set(const SetJob& job, SetInMaking& making, Progress& progress) {
  SetOfTemplates& made = making.made;
  for (const Json& row : making.rows)
    if (row["vertices"] == 0)
      making.warnings.push_back(row["name"].get<std::string>() + ": has no template in the set (" +
                                row["warning"].get<std::string>() + ")");
  if (made.templates.empty())
    return fail(
        job.maps.front().string(),
        "gives no template at all; the first reason: " +
            (making.rows.empty() ? making.warnings.front() : making.rows.front()["warning"].get<std::string>()));
  // Of what is there now: the set itself may be changed.
  const auto record = record_of(job.command, progress);
  if (!record) return fail(record.error());
  const auto old_files = templates_of_old_set(job);
  std::vector<fs::path> to_write;
  for (std::size_t k = 0; k < made.templates.size(); ++k)
    if (making.files[k].triangles.rows() > 0) to_write.push_back(made.set.structures[k].file);
  if (auto own = check_own(job, to_write, progress); !own) return fail(own.error());
  std::vector<Mesh> meshes;
  FilesOfRun new_files;
  for (std::size_t k = 0; k < made.templates.size(); ++k) {
    const Template& one = *made.templates[k];
    meshes.push_back({one.topology, one.points});
    if (making.files[k].triangles.rows() > 0) {
      making.files[k].record = record_of_made(*record, job.out, made.set.structures[k].file);
      if (std::error_code ignored; !fs::exists(made.set.structures[k].file, ignored))
        new_files.files.push_back(made.set.structures[k].file);
      if (auto written = write_mesh_file(making.files[k], made.set.structures[k].file); !written)
        return fail(written.error());
    }
    if (making.relative[k].empty() || made.templates.size() < 2) continue;
    made.set.structures[k].pose = relative_pose(making.relative[k], one.points.colwise().mean());
  }
  find_partners(made.set);
  find_neighbours(made.set, meshes, near_mm);
  if (auto written = write_template_set(made.set, job.out, job.in_place ? "" : *record); !written)
    return fail(written.error());
  new_files.files.clear();
  name_left_over(job, old_files, made.set, making.warnings);
  for (Json& row : making.rows)
    if (const TemplateOfSet* one = made.set.find(row["name"].get<std::string>()); one != nullptr && one->pose)
      row["pose"] = json_of_pose(*one->pose);
  Report report;
  report.warnings = std::move(making.warnings);
  report.values = {{"set", job.out.string()}, {"structures", making.rows}};
  return report;
}

}  // namespace homolog
