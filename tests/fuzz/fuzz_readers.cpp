#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

#include "app/editor/update/command_log.h"
#include "core/base/pictures/picture_readers.h"
#include "core/model/files/hdf_tree.h"
#include "core/model/files/statismo.h"
#include "core/model/shapes/study.h"
#include "core/session/case_file.h"
#include "core/volume/labels/label_tables.h"
#include "tests/readers.h"

// Feeds made-up files to one reader, by libFuzzer. The reader is chosen by the program's own name: fuzz_nii reads
// NIfTI. Whatever a file holds, a reader may refuse it or read it, and no more: no crash, no sanitizer's report, not
// much memory. A case may name octahedron.obj and image.mha, which lie beside it.
using namespace homolog;

namespace {

namespace fs = std::filesystem;

/// What libFuzzer calls the reader by, how its files end, and what reads one.
struct Reader {
  std::string_view name;
  const char* ending;
  void (*read)(const fs::path&);
};

void volume(const fs::path& path) {
  (void)test::read_a_volume(path);
}

void mesh(const fs::path& path) {
  if (const auto file = read_mesh_file(path)) (void)sound_mesh(*file);
}

/// Every reader of names of labels, whatever the file's name would choose.
void labels(const fs::path& path) {
  const auto text = read_whole_file(path);
  if (!text) return;
  (void)labels_of_json(*text);
  (void)labels_of_lines(*text);
  (void)labels_of_table(*text);
  (void)labels_of_xml(*text);
}

void landmarks(const fs::path& path) {
  (void)test::read_some_landmarks(path);
}

/// Pages as volumes take them, in as much room as they say.
template <auto pages_of, auto read_all>
void pages(const fs::path& path) {
  const auto found = pages_of(path);
  constexpr std::size_t most = std::size_t{1} << 26;
  if (!found) return;
  const double wanted = static_cast<double>(found->width) * found->height * static_cast<double>(size_of(found->values));
  if (wanted > static_cast<double>(most)) return;
  std::vector<std::byte> room(static_cast<std::size_t>(wanted));
  std::size_t begin = 0;
  (void)read_all(path, *found, [&](std::size_t bytes) -> Result<std::span<std::byte>> {
    if (begin == room.size()) begin = 0;  // the next page
    begin += bytes;
    if (begin > room.size()) std::abort();
    return std::span(room).subspan(begin - bytes, bytes);
  });
}

void png(const fs::path& path) {
  (void)read_png(path);
  pages<png_pages, read_png_page>(path);
}

void tree(const fs::path& path) {
  (void)read_hdf5_json(
      path, {{{"/version", "name"}}, {"/model/mean", "/model/pcaBasis", "/representer/cells"}, {"/model/b_"}});
}

void json(const fs::path& path) {
  (void)test::read_some_json(path);
}

void model(const fs::path& path) {
  (void)read_model(path);
}

void case_file(const fs::path& path) {
  (void)read_case(path);
}

void study(const fs::path& path) {
  (void)read_study(path);
}

void command_log(const fs::path& path) {
  (void)read_log(path);
}

constexpr Reader readers[] = {{"nii", ".nii", volume},
                              {"niigz", ".nii.gz", volume},
                              {"nrrd", ".nrrd", volume},
                              {"mha", ".mha", volume},
                              {"mgh", ".mgh", volume},
                              {"labels", ".txt", labels},
                              {"dcm", ".dcm", volume},
                              {"png", ".png", png},
                              {"tif", ".tif", pages<tiff_pages, read_tiff_pages>},
                              {"ply", ".ply", mesh},
                              {"vtk", ".vtk", mesh},
                              {"vtp", ".vtp", mesh},
                              {"vtu", ".vtu", mesh},
                              {"obj", ".obj", mesh},
                              {"gii", ".gii", mesh},
                              {"msh", ".msh", mesh},
                              {"stl", ".stl", mesh},
                              {"particles", ".particles", mesh},
                              {"mrk", ".mrk.json", landmarks},
                              {"fcsv", ".fcsv", landmarks},
                              {"h5json", ".h5.json", tree},
                              {"json", ".json", json},
                              {"model", ".h5.json", model},
                              {"h5", ".h5", model},
                              {"case", ".homolog", case_file},
                              {"study", ".study.json", study},
                              {"log", ".log", command_log}};

const Reader* chosen = nullptr;
fs::path file;

void write_file(const fs::path& path, const void* bytes, std::size_t size) {
  std::FILE* const out = std::fopen(path.c_str(), "wb");
  if (out == nullptr) std::abort();
  std::fwrite(bytes, 1, size, out);
  std::fclose(out);
}

void write_text(const fs::path& path, std::string_view text) {
  write_file(path, text.data(), text.size());
}

}  // namespace

// NrrdIO loses 88 bytes over a header line that is no field, each time it refuses such a file. No other library of the
// readers calls this function.
extern "C" const char* __lsan_default_suppressions() {
  return "leak:itk_airArrayNew\n";
}

extern "C" int LLVMFuzzerInitialize(int*, char*** arguments) {
  const std::string name = fs::path((*arguments)[0]).filename().string();
  for (const Reader& reader : readers)
    if (name == "fuzz_" + std::string(reader.name)) chosen = &reader;
  if (chosen == nullptr) {
    std::fprintf(stderr, "fuzz_readers: is called by the name of no reader (fuzz_nii, …); use scripts/fuzz.sh\n");
    std::exit(2);
  }
  const fs::path folder = fs::temp_directory_path() / ("homolog-fuzz-" + std::to_string(::getpid()));
  fs::create_directory(folder);
  file = folder / (std::string("file") + chosen->ending);
  write_text(folder / "octahedron.obj",
             "# SPACE=LPS\nv 1 0 0\nv -1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1\n"
             "f 1 3 5\nf 3 2 5\nf 2 4 5\nf 4 1 5\nf 3 1 6\nf 2 3 6\nf 4 2 6\nf 1 4 6\n");
  write_text(folder / "image.mha",
             "ObjectType = Image\nNDims = 3\nDimSize = 4 3 2\nElementType = MET_UCHAR\nElementSpacing = 1 1 2\n"
             "Offset = 0 0 0\nElementDataFile = LOCAL\nabcdefghijklmnopqrstuvwx");
  std::atexit([] {
    std::error_code ignored;
    fs::remove_all(file.parent_path(), ignored);
  });
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  write_file(file, data, size);
  chosen->read(file);
  return 0;
}
