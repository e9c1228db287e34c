#include "app/verbs/files/write_labels.h"

#include "app/verbs/read_image.h"
#include "core/base/text/text.h"
#include "core/volume/dicom/dicom_series.h"
#include "core/volume/dicom/write_dicom_segmentation.h"
#include "core/volume/labels/write_segmentation.h"

namespace homolog {

namespace fs = std::filesystem;

bool is_dicom_name(const fs::path& path) {
  return lower_case(path.extension().string()) == ".dcm";
}

Result<std::vector<std::string>> write_labels(const VolumeRead& map, const fs::path& out, const fs::path& series,
                                              Progress& progress, const std::string& record,
                                              const std::string& series_uid) {
  if (is_dicom_name(out) && series.empty())
    return fail(out.string(), "becomes a DICOM segmentation, which refers to a series of images; name it by --like");
  if (is_dicom_name(out)) return write_dicom_segmentation(map, out, series, &progress, series_uid);
  if (auto written = write_segmentation(map, out, &progress, record); !written) return fail(written.error());
  return std::vector<std::string>();
}

LikeImage like_of(LikeImage like, const ReferencedImages& made_on) {
  const bool named = like.series && !like.series->empty();
  like.path = folder_of_series(like.path, named ? std::vector{*like.series} : made_on.series);
  return like;
}

Result<VolumeRead> read_like(const LikeImage& like, const ReferencedImages& made_on, Progress& progress) {
  const std::string series = like.series.value_or("");
  if (auto usable = check_reading(like.path, series, false, like.resample); !usable) return fail(usable.error());
  VolumeReadOptions options = read_options(series, {}, progress, like.resample);
  options.of_images = made_on;
  options.names_no_series = !like.series;
  return read_volume(like.path, options);
}

}  // namespace homolog
