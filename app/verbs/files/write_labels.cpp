#include "app/verbs/files/write_labels.h"

#include "app/verbs/read_image.h"
#include "core/base/text/text.h"
#include "core/volume/dicom/write_dicom_segmentation.h"
#include "core/volume/labels/write_segmentation.h"

namespace homolog {

namespace fs = std::filesystem;

bool is_dicom_name(const fs::path& path) {
  return lower_case(path.extension().string()) == ".dcm";
}

Result<std::vector<std::string>> write_labels(const VolumeRead& map, const fs::path& out, const fs::path& series,
                                              Progress& progress, const std::string& record) {
  if (is_dicom_name(out) && series.empty())
    return fail(out.string(), "becomes a DICOM segmentation, which refers to a series of images; name it by --like");
  if (is_dicom_name(out)) return write_dicom_segmentation(map, out, series, &progress);
  if (auto written = write_segmentation(map, out, &progress, record); !written) return fail(written.error());
  return std::vector<std::string>();
}

Result<VolumeRead> read_like(const fs::path& path, bool resample, Progress& progress) {
  if (auto usable = check_reading(path, "", false, resample); !usable) return fail(usable.error());
  return read_volume(path, read_options("", {}, progress, resample));
}

}  // namespace homolog
