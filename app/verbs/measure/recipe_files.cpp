#include "app/verbs/measure/recipe_files.h"

#include <algorithm>

#include "app/verbs/case_landmarks.h"
#include "app/verbs/read_image.h"
#include "core/base/text/listed.h"
#include "core/mesh/files/landmark_io.h"

namespace homolog {

namespace {

/// The folder of a shape's own folder's name in one that holds files of shapes, and then that one.
std::vector<std::filesystem::path> folders_for(const OfCase& of, const std::filesystem::path& folder) {
  std::error_code ignored;
  const auto own = folder / std::filesystem::absolute(of.source, ignored).parent_path().filename();
  if (of.source.empty() || !std::filesystem::is_directory(own, ignored)) return {folder};
  return {own, folder};
}

/// Remembers of which shape a file is; gives another one that it was taken for.
std::optional<std::filesystem::path> taken_for(const OfCase& of, const std::filesystem::path& file,
                                               std::map<std::filesystem::path, std::filesystem::path>& taken) {
  const auto& first = taken.emplace(file, of.source).first->second;
  return first == of.source ? std::nullopt : std::optional(first);
}

/// The image of one of these names in a folder; of several the last. Empty: there is none.
std::filesystem::path image_in(const std::filesystem::path& folder, const std::vector<std::string>& stems) {
  std::filesystem::path file;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored))
    if (std::ranges::count(stems, case_name_of(entry.path())) > 0 && looks_like_volume(entry.path()))
      file = std::max(file, entry.path());
  return file;
}

}  // namespace

Result<void> FilesOfShapes::add_landmarks(const OfCase& of, bool alone, MeasuredStructure& structure) {
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
  } else if (!alone)
    return fail(file.string(), "is one file for several shapes; give the folder with a file of each shape's name");
  if (file.empty()) return {};
  auto read = read_landmarks(file);
  if (!read) return fail(read.error());
  for (const Landmark& placed : *read)
    std::erase_if(structure.landmarks, [&](const Landmark& own) { return own.name == placed.name; });
  structure.landmarks.insert(structure.landmarks.end(), read->begin(), read->end());
  return {};
}

Result<void> FilesOfShapes::add_image(const OfCase& of, const std::string& name, MeasuredShape& shape,
                                      std::vector<std::string>& warnings) {
  if (job_.image.empty()) return {};
  const int frame = of.frame.value_or(0);
  std::filesystem::path file = job_.image;
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored)) {
    file.clear();
    for (const auto& folder : folders_for(of, job_.image))
      if (file.empty()) file = image_in(folder, of.stems);
    if (file.empty()) {
      warnings.push_back(name + ": has no image in " + job_.image.string() + " (" + listed(of.stems, " or ") +
                         ".nii.gz); call it so");
      return {};
    }
    if (const auto other = taken_for(of, file, images_taken_))
      warnings.push_back(file.string() + ": is sampled for " + other->string() + " and for " + of.source.string() +
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

}  // namespace homolog
