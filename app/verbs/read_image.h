#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>

#include "app/verbs/verb.h"
#include "core/volume/volume_io.h"

namespace homolog {

// Volumes as verbs take them: a file, and which frame and label of it. Errors name the file and the option.

using LentImages = std::multimap<std::filesystem::path, std::shared_ptr<const VolumeRead>>;

/// While it lives, whoever reads the image or label map `name` gets this one: for a program that has it in memory and
/// does a verb in its own process [python/]. Any thread may make one. Images that live at a time under one name must be
/// alike.
class ImageInMemory {
 public:
  ImageInMemory(std::filesystem::path name, std::shared_ptr<const VolumeRead> image);
  ~ImageInMemory();
  ImageInMemory(const ImageInMemory&) = delete;
  ImageInMemory& operator=(const ImageInMemory&) = delete;

 private:
  LentImages::iterator place_;
};

/// The image, of which `frame` must exist. `resample`: VolumeReadOptions::resample; an error where it has no effect
/// [check_reading]. `of_images`: VolumeReadOptions::of_images.
Result<VolumeRead> read_image(const std::filesystem::path& path, int frame, Progress& progress, bool resample = false,
                              const ReferencedImages& of_images = {});

/// The warning that a frame was taken of several that nobody asked for.
std::string frame_taken(const std::filesystem::path& path, int frames, int frame);

/// Adds `--spacing X,Y,Z` in mm; without it `spacing_mm` stays empty.
void add_spacing_option(CLI::App& verb, std::vector<double>& spacing_mm);
/// Adds `--resample`: VolumeReadOptions::resample.
void add_resample_option(CLI::App& verb, bool& resample);
/// The options that --series, --spacing and --resample ask for.
VolumeReadOptions read_options(const std::string& series, const std::vector<double>& spacing_mm, Progress& progress,
                               bool resample = false);
/// A mesh has neither series nor spacing, only a folder holds several series, and only DICOM slices are resampled. A
/// volume's own header is not overruled: that is a warning.
Result<std::vector<std::string>> check_reading(const std::filesystem::path& path, const std::string& series,
                                               bool spacing, bool resample = false);
/// Says in a report how slices became a rectangular grid, where they did.
void report_resampled(const VolumeRead& read, Json& values);

/// Adds `--label N`, `--label NAME`, or several for what they cover together; `label` is empty without it.
CLI::Option* add_label_option(CLI::App& verb, std::string& label, const std::string& help);

/// Adds `--NAME-mm R`, the radius of a ball; without it `radius_mm` stays empty: a share of the organ's size.
CLI::Option* add_ball_option(CLI::App& verb, const std::string& name, std::optional<double>& radius_mm,
                             const std::string& help);

/// Which frame of a label map is meant, and where the surface of a soft mask lies.
struct MaskAsked {
  std::optional<int> frame;       ///< by --frame
  std::optional<int> of_mesh;     ///< the frame that the mesh belongs to which meets it [noted_frame]
  std::optional<double> level{};  ///< by --level
  bool voxels_alone = false;      ///< soft masks are rounded to voxels
  bool among_others = false;      ///< other labels count too, so that one of several soft masks is rounded
};
/// Adds `--frame K`; without it `frame` stays empty.
CLI::Option* add_mask_frame_option(CLI::App& verb, std::optional<int>& frame);
/// Adds `--level L`; without it `level` stays empty.
CLI::Option* add_level_option(CLI::App& verb, std::optional<double>& level);

struct MaskRead : VolumeRead {
  int label = 0;                  ///< the union's, if several were asked for: the first of them
  int frame = 0;                  ///< which is meant
  std::vector<int> from;          ///< the labels that it holds
  std::optional<double> level{};  ///< the value of a soft mask at which its surface lies

  /// A sentence about `label` that names all of `from`: "label 1+2".
  std::string named(std::string sentence) const;
  std::vector<std::string> named(std::vector<std::string> sentences) const;
  /// Says in a report which frame was taken, where there are several, and that the mask is soft.
  void report(Json& values) const {
    if (volume.frames > 1) values["frame"] = frame;
    if (level) values.update(Json{{"soft", true}, {"level", *level}});
  }
};
/// A label map, and which frame and label of it are meant. The frame: the one that is asked for, else the one that the
/// mesh belongs to, else the first, with a warning where there are several. The label: what `label` names
/// [choose_segments], together, or the only one where it is empty; of a soft mask [soft_mask.h] there is only label 1.
/// Errors: a frame without them names those that hold some.
Result<MaskRead> read_mask(const std::filesystem::path& path, const std::string& label, const MaskAsked& asked,
                           Progress& progress);
/// The same of a label map that was read from there.
Result<MaskRead> chosen_mask(VolumeRead read, const std::filesystem::path& path, const std::string& label,
                             const MaskAsked& asked);

}  // namespace homolog
