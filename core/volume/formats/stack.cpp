#include <algorithm>
#include <cctype>
#include <cmath>

#include "core/base/pictures/picture_module.h"
#include "core/base/processes/memory.h"
#include "core/volume/formats/formats.h"
#include "core/volume/readers.h"

// Stacks of PNG or TIFF slices, through the picture module.
namespace homolog {
namespace fs = std::filesystem;

namespace {

/// slice2 before slice10: runs of digits are compared as numbers.
bool natural_less(const std::string& a, const std::string& b) {
  const auto digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (digit(a[i]) && digit(b[j])) {
      while (i < a.size() && a[i] == '0') ++i;
      while (j < b.size() && b[j] == '0') ++j;
      const std::size_t begin_a = i, begin_b = j;
      while (i < a.size() && digit(a[i])) ++i;
      while (j < b.size() && digit(b[j])) ++j;
      if (i - begin_a != j - begin_b) return i - begin_a < j - begin_b;
      const int order = a.compare(begin_a, i - begin_a, b, begin_b, j - begin_b);
      if (order != 0) return order < 0;
    } else {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i;
      ++j;
    }
  }
  return a.size() - i < b.size() - j;
}

/// The runs of digits in a name.
std::vector<std::string> digits_in(const std::string& name) {
  std::vector<std::string> runs;
  bool within = false;
  for (const char c : name) {
    const bool digit = std::isdigit(static_cast<unsigned char>(c)) != 0;
    if (digit && !within) runs.emplace_back();
    if (digit) runs.back() += c;
    within = digit;
  }
  return runs;
}

tl::unexpected<Error> unlike(const fs::path& folder, const fs::path& one, const fs::path& other) {
  return fail(folder.string(), "holds slices that are named differently (" + one.filename().string() + " and " +
                                   other.filename().string() + "); keep those of one stack");
}

/// By how much the one number in which two names differ rises. Nothing where several do, as in a scan of several parts,
/// or where it is no count but a date with a time, or an identifier.
std::optional<double> step_between_names(const std::vector<std::string>& before, const std::vector<std::string>& here) {
  constexpr std::size_t longest_count = 15;
  std::optional<double> step;
  for (std::size_t i = 0; i < here.size(); ++i) {
    if (here[i] == before[i]) continue;
    if (step || std::max(here[i].size(), before[i].size()) > longest_count) return {};
    step = std::stod(here[i]) - std::stod(before[i]);
  }
  return step;
}

/// Numbers of slices rise by one step. A slice is missing where nearly all do and one rises by a multiple of it;
/// numbers that rise this way and that are times, or tell nothing.
Result<void> check_steps(const fs::path& folder, const std::vector<fs::path>& files) {
  std::vector<double> steps;
  std::vector<std::string> before = digits_in(files.front().filename().string());
  for (std::size_t k = 1; k < files.size(); ++k) {
    std::vector<std::string> here = digits_in(files[k].filename().string());
    const auto step = step_between_names(before, here);
    if (!step) return {};
    steps.push_back(*step);
    before = std::move(here);
  }
  if (steps.empty()) return {};
  std::vector<double> sorted = steps;
  std::sort(sorted.begin(), sorted.end());
  const double usual = sorted[(sorted.size() - 1) / 2];
  const auto others = steps.size() - static_cast<std::size_t>(std::count(steps.begin(), steps.end(), usual));
  if (usual <= 0 || (others > 1 && 4 * others > steps.size())) return {};
  for (std::size_t k = 0; k < steps.size(); ++k)
    if (steps[k] != usual && std::fmod(steps[k], usual) == 0)
      return fail(folder.string(),
                  "lacks slices: from " + files[k].filename().string() + " to " + files[k + 1].filename().string() +
                      " the number does not rise by the same step as elsewhere; copy the stack again, or number "
                      "its files evenly");
  return {};
}

/// Names tell whether a slice is missing: those of one stack differ in a number alone.
Result<void> check_names(const fs::path& folder, const std::vector<fs::path>& files) {
  const std::string alike = name_without_numbers(files.front());
  const bool numbered = alike.find('#') != std::string::npos;
  for (const fs::path& file : files) {
    if (lower_case_name(file.extension()) != lower_case_name(files.front().extension()))
      return unlike(folder, files.front(), file);
    if (numbered && name_without_numbers(file) != alike) return unlike(folder, files.front(), file);
  }
  if (!numbered) return {};
  return check_steps(folder, files);
}

struct PictureStack {
  std::vector<fs::path> files;
  PicturePages pages;  ///< the pages of every file
};

Result<PictureStack> find_stack(const fs::path& path, const PictureModule& module) {
  PictureStack stack;
  std::error_code error, not_a_file;
  if (fs::is_directory(path, error)) {
    for (auto entry = fs::directory_iterator(path, error); !error && entry != fs::directory_iterator();
         entry.increment(error))
      if (has_ending(entry->path(), formats::stack.endings) && !is_hidden(entry->path()))
        stack.files.push_back(entry->path());
    if (error) return fail(path.string(), "cannot be listed (" + error.message() + ")");
    for (const fs::path& file : stack.files)
      if (!fs::is_regular_file(file, not_a_file))
        return fail(
            file.string(),
            "is named like a slice but is not a file; copy the stack again, or move it elsewhere if it is no part "
            "of it");
    std::sort(stack.files.begin(), stack.files.end());
    std::stable_sort(stack.files.begin(), stack.files.end(), [](const fs::path& a, const fs::path& b) {
      return natural_less(lower_case_name(a), lower_case_name(b));
    });
    if (auto whole = check_names(path, stack.files); !whole) return fail(whole.error());
  } else {
    stack.files.push_back(path);
  }
  for (const fs::path& file : stack.files) {
    const auto pages = module.pages(file);
    if (!pages) return fail(pages.error());
    if (file == stack.files.front()) stack.pages = *pages;
    if (*pages != stack.pages)
      return fail(path.string(), "mixes slices of different sizes or types (" +
                                     stack.files.front().filename().string() + " and " + file.filename().string() +
                                     "); keep those of one stack");
  }
  return stack;
}

Result<VolumeRead> read_stack(const fs::path& path, const VolumeReadOptions& options) {
  if (!options.stack_spacing_mm)
    return fail(path.string(),
                "is a stack of pictures, which do not say how large a voxel is; give it in mm with "
                "--spacing X,Y,Z");
  const auto module = picture_module();
  if (!module) return fail(module.error());
  const auto stack = find_stack(path, **module);
  if (!stack) return fail(stack.error());
  const auto& [width, height, pages, type] = stack->pages;
  const auto slices = static_cast<std::int64_t>(stack->files.size()) * pages;

  VolumeRead result;
  // Pictures say nothing of the patient: columns to the left, rows to the back, slices to the head.
  auto geometry = make_geometry(path, {width, height, slices}, options.stack_spacing_mm->asDiagonal(), Vec3::Zero());
  if (!geometry) return fail(geometry.error());
  result.volume.geometry = *geometry;
  if (const auto enough = check_memory(path, bytes_while_reading(type, claimed_voxels(*geometry, 1), false)); !enough)
    return fail(enough.error());
  StoredVoxels stored = make_stored_voxels(type, 0);
  reserve_voxels(stored, geometry->voxels());
  Progress* const progress = options.progress;
  const std::size_t voxel_bytes = size_of(type);
  const auto all_bytes = static_cast<double>(geometry->voxels() * voxel_bytes);
  double arrived = 0;
  const PageRoom room = [&](std::size_t bytes) -> Result<std::span<std::byte>> {
    if (progress && progress->cancelled()) return fail(path.string(), "was not read: cancelled");
    if (progress) progress->report(arrived / all_bytes);
    arrived += static_cast<double>(bytes);
    return add_voxels(stored, bytes / voxel_bytes);
  };
  for (const fs::path& file : stack->files)
    if (const auto read = (*module)->read_pages(file, stack->pages, room); !read) return fail(read.error());
  if (auto kept = keep_voxels(std::move(stored), {}, path.string(), result.volume, result.warnings); !kept)
    return fail(kept.error());
  return result;
}

}  // namespace

const VolumeFormat formats::stack{
    .name = "a stack of PNG or TIFF slices",
    .endings = {".png", ".tif", ".tiff"},
    .in_folder = "PNG or TIFF slices",
    .note = "a folder in the order of its names, or the pages of one TIFF; the spacing must be given",
    .read = read_stack};

}  // namespace homolog
