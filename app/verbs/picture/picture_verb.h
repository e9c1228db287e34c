#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/pictures/pictures.h"
#include "app/verbs/verb.h"

namespace homolog {

/// The arguments of the verbs of `picture`.
struct PictureVerb {
  std::vector<std::filesystem::path> in;
  std::filesystem::path out;
  std::string size = "1280x960", view = "anterior";
  double glyph_spacing_mm = 0, width_mm = 0;
  bool transparent = false, all_frames = false, flip_mirrored = false, captions = false;
  std::string ground, only;             ///< empty: as it always was
  std::vector<std::string> structures;  ///< joined; empty: shapes of one
  std::string structure;                ///< the only one of those to show; empty: all
  int modes = 2, mode = 0, frames = 40;

  /// On paper lengths count, in pixels on a screen those.
  bool is_for_print() const { return width_mm > 0 || is_page_name(out); }
};

inline constexpr double usual_page_mm = 170;  ///< as wide as the text of a journal's page

/// {width, height} of WIDTHxHEIGHT in pixels; nullopt where the text is no size.
std::optional<std::pair<int, int>> parsed_size(const std::string& text);
/// The command line was checked when it was parsed.
MontageOptions montage_options(const PictureVerb& verb);
/// The error with the first input as its subject, where it has none.
Error about(const PictureVerb& verb, Error error);
/// Writes a page by its name's ending, and reports its size.
Result<Report> write_plate(const Result<Page>& page, const PictureVerb& verb);
/// --width-mm; --view.
CLI::Option* add_width(CLI::App& verb, PictureVerb& options);
void add_view(CLI::App& verb, PictureVerb& options);
bool is_gif_name(const std::filesystem::path& path);
/// The pictures for print of what was measured: map, groups, score, plot.
void add_plates(CLI::App& picture, const std::shared_ptr<PictureVerb>& options, CommandLine& asked);

}  // namespace homolog
