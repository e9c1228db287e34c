#include "app/verbs/template/subjects.h"

#include <algorithm>

#include "app/verbs/case_landmarks.h"
#include "app/verbs/case_pool.h"
#include "app/verbs/describe.h"
#include "app/verbs/input_folders.h"
#include "app/verbs/read_image.h"
#include "core/groupwise/cohort_template.h"
#include "core/mesh/files/landmark_io.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

Result<std::vector<Landmark>> landmarks_beside(const SubjectFiles& files, const std::string& name) {
  if (files.landmarks.empty()) return std::vector<Landmark>();
  if (const fs::path file = landmark_file_in(files.landmarks, name); !file.empty()) return read_landmarks(file);
  return fail(name, "has no landmark file in " + files.landmarks.string() + " (" + name +
                        ".mrk.json, .fcsv or .json); put one there, or leave the case out");
}

/// Makes the boundary of a whole label that of the part that faces others. Errors: the map lacks them; those of
/// faced_part.
Result<void> take_part(const FacedNames& names, const MaskRead& mask, Boundary& boundary) {
  const auto faced = faced_labels(names, mask.segmentation);
  if (!faced) return fail(faced.error());
  auto part = faced_part(boundary.surface, mask.volume, mask.label, mask.frame, *faced);
  if (!part) return fail("", mask.named(part.error().what));
  if (auto left_out = take_largest_piece(*part, mask.label))
    boundary.warnings.push_back(mask.named(std::move(*left_out)));
  boundary.surface = std::move(*part);
  return {};
}

Result<BiasSubject> read_one_subject(const SubjectFiles& files, const fs::path& path,
                                     std::vector<std::string>& warnings, std::optional<int>& frame,
                                     Progress& progress) {
  BiasSubject subject;
  subject.name = case_name_of(path);
  if (is_mesh_name(path)) {
    const auto mesh = read_mesh_to_mend(path);
    if (!mesh) return fail(mesh.error());
    auto boundary = surface_boundary(*mesh, files.vertices, &progress);
    if (!boundary) return fail(path.string(), boundary.error().what);
    subject.boundary = std::move(*boundary);
  } else {
    auto mask = read_mask(path, files.label, {files.frame, {}, files.level, false, files.faced.has_value()}, progress);
    if (!mask) return fail(mask.error());
    warnings.insert(warnings.end(), mask->warnings.begin(), mask->warnings.end());
    if (mask->volume.frames > 1) frame = mask->frame;
    auto boundary = label_boundary(mask->volume, mask->label, mask->frame, files.closing_mm, files.vertices);
    if (!boundary) return fail(path.string(), boundary.error().what);
    subject.boundary = std::move(*boundary);
    if (files.faced)
      if (auto taken = take_part(*files.faced, *mask, subject.boundary); !taken)
        return fail(path.string(), taken.error().what);
  }
  for (std::string& warning : about(path, subject.boundary.warnings)) warnings.push_back(std::move(warning));
  auto landmarks = landmarks_beside(files, subject.name);
  if (!landmarks) return fail(landmarks.error());
  subject.landmarks = std::move(*landmarks);
  return subject;
}

void flip_subject(BiasSubject& subject) {
  subject.boundary = mirrored_boundary(subject.boundary);
  for (Landmark& landmark : subject.landmarks) landmark.position.x() *= -1;
}

}  // namespace

std::vector<fs::path> subject_paths(const std::vector<fs::path>& files) {
  bool any = false, any_maps = false;
  const auto opened = with_folders_opened(files, surfaces_in, any);
  auto paths = with_folders_opened(opened, volumes_in, any_maps);
  if (any_maps) paths = label_maps_among(paths);
  std::sort(paths.begin(), paths.end(), [](const fs::path& a, const fs::path& b) {
    return std::pair(case_name_of(a), a.string()) < std::pair(case_name_of(b), b.string());
  });
  return paths;
}

Result<SubjectsRead> read_subjects(const SubjectFiles& files, Progress& progress) {
  std::vector<fs::path> paths = subject_paths(files.files);
  for (std::size_t k = 1; k < paths.size(); ++k)
    if (case_name_of(paths[k]) == case_name_of(paths[k - 1]))
      return fail(paths[k].string(), "has the name of " + paths[k - 1].string() + "; rename one of them");
  std::error_code ignored;
  for (const fs::path& path : paths)
    if (fs::is_directory(path, ignored) && fs::is_empty(path, ignored))
      return fail(path.string(), "holds no surfaces and no label maps; name the files themselves");
  if (paths.empty())
    return fail(files.files.front().string(), "holds no surfaces and no label maps; name the files themselves");
  if ((!files.label.empty() || files.closing_mm || files.frame || files.level || files.faced) &&
      std::all_of(paths.begin(), paths.end(), is_mesh_name))
    return fail(files.files.front().string(),
                "is no label map, so --label, --frame" + std::string(files.level ? ", --level" : "") +
                    (files.faced ? ", --facing, --open-at" : "") + " and --closing-mm have no effect; leave them out");
  SubjectsRead read;
  read.subjects.resize(paths.size());
  std::vector<std::vector<std::string>> warnings(paths.size());
  std::vector<std::optional<int>> frames(paths.size());
  const auto results = run_cases(
      paths.size(),
      [&](std::size_t k, Progress& own) -> Result<Report> {
        set_case_in_work(case_name_of(paths[k]));
        auto subject = read_one_subject(files, paths[k], warnings[k], frames[k], own);
        if (!subject) return fail(subject.error());
        read.subjects[k] = std::move(*subject);
        return Report{};
      },
      progress);
  for (std::size_t k = 0; k < results.size(); ++k) {
    if (!results[k]) return fail(results[k].error());
    read.warnings.insert(read.warnings.end(), warnings[k].begin(), warnings[k].end());
    if (frames[k]) read.frames[read.subjects[k].name] = *frames[k];
  }
  std::vector<Meeting> met;
  for (std::size_t k = 0; k < paths.size(); ++k)
    met.push_back(meeting_of(paths[k], read.subjects[k].boundary.surface.points));
  for (std::string& sentence : misfits_among(met, "the other subjects")) read.warnings.push_back(std::move(sentence));
  std::vector<const Boundary*> boundaries;
  std::vector<std::string> names;
  for (const BiasSubject& subject : read.subjects) {
    boundaries.push_back(&subject.boundary);
    names.push_back(subject.name);
  }
  for (std::string& sentence : volume_warnings(names, boundaries)) read.warnings.push_back(std::move(sentence));
  const std::string others = boundaries.size() == 2 ? "the other subject" : "most others";
  for (const std::size_t k : mirrored_subjects(boundaries, &progress)) {
    BiasSubject& subject = read.subjects[k];
    if (!files.flip_mirrored) {
      read.warnings.push_back(subject.name + ": looks like a mirror image of " + others +
                              "; check its side, and flip such subjects with --flip-mirrored, or leave it out");
      continue;
    }
    flip_subject(subject);
    read.flipped.push_back(subject.name);
  }
  read.paths = std::move(paths);
  return read;
}

}  // namespace homolog
