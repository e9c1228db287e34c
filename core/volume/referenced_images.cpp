#include "core/volume/referenced_images.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/text/text.h"

namespace homolog {
namespace fs = std::filesystem;

namespace {

std::string name_of_plane(const std::string& uid, int frame) {
  return uid + ":" + std::to_string(frame);
}

}  // namespace

std::string named_image(const DicomItem& reference) {
  constexpr DicomTag instance = 0x00081155, frame_number = 0x00081160;
  const std::string uid = text_of(reference, instance);
  const auto frames = numbers_of(reference, frame_number);
  constexpr double most_frames = 1e9;
  if (uid.empty() || frames.size() > 1) return {};
  return !frames.empty() && std::abs(frames.front()) < most_frames
             ? name_of_plane(uid, static_cast<int>(frames.front()))
             : uid;
}

std::map<std::string, const SourceImage*> images_by_name(const std::vector<SourceImage>& images) {
  std::map<std::string, const SourceImage*> found;
  const auto add = [&](const std::string& name, const SourceImage& image) {
    const auto [at, is_new] = found.try_emplace(name, &image);
    if (!is_new) at->second = nullptr;
  };
  for (const SourceImage& image : images) {
    if (image.frame == 0) add(image.uid, image);
    add(name_of_plane(image.uid, std::max(1, image.frame)), image);
  }
  return found;
}

std::optional<std::string> other_images(const fs::path& path, const ReferencedImages& referenced,
                                        const std::string& image, const std::string& series_uid,
                                        const std::vector<SourceImage>& images) {
  const auto& series = referenced.series;
  if (!series.empty() && !series_uid.empty() && std::ranges::find(series, series_uid) == series.end())
    return path.string() + ": refers to the series " + excerpt(series.front()) + ", and " + image + " is series " +
           excerpt(series_uid) + " in the same space; check that it was made on that image";
  std::set<std::string> there;
  for (const SourceImage& one : images) there.insert(one.uid);
  const std::set<std::string> wanted(referenced.instances.begin(), referenced.instances.end());
  const auto lacking = std::ranges::count_if(wanted, [&](const std::string& uid) { return !there.contains(uid); });
  if (there.empty() || lacking == 0) return {};
  return path.string() + ": refers to " + std::to_string(wanted.size()) +
         (wanted.size() == 1 ? " image, " : " images, ") +
         (lacking == std::ssize(wanted) ? std::string("none") : std::to_string(lacking)) + " of which " +
         (lacking == std::ssize(wanted) ? "is"
          : lacking == 1                ? "is not"
                                        : "are not") +
         " in " + image + "; check that it was made on that image, and that no slice of it is missing";
}

Result<std::optional<std::string>> check_scan(const fs::path& path, const std::string& frame_of_reference,
                                              const ReferencedImages& referenced, const fs::path& image_path,
                                              const Volume& image, const std::string& how) {
  const bool known = !frame_of_reference.empty() && !image.frame_of_reference.empty();
  if (known && frame_of_reference != image.frame_of_reference)
    return fail(path.string(), "was drawn on another scan than " + image_path.string() + " (frames of reference " +
                                   excerpt(frame_of_reference) + " and " + excerpt(image.frame_of_reference) +
                                   "); give the series that it was drawn on" + how);
  if (image.modality == "SEG") return std::optional<std::string>();  // its series is one of its own
  if (referenced.series.empty() && referenced.instances.empty() && !referenced.study.empty() &&
      !image.study_uid.empty() && referenced.study != image.study_uid)
    return path.string() + ": is of the study " + excerpt(referenced.study) + ", and " + image_path.string() +
           " of the study " + excerpt(image.study_uid) +
           "; it names no image that it was made on, so check that it was made on that image";
  return other_images(path, referenced, image_path.string(), image.series_uid, image.images);
}

}  // namespace homolog
