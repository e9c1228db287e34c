#include <sys/wait.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <random>
#include <sstream>

#include "core/base/files/files.h"
#include "tests/command_line.h"
#include "tests/real_data.h"
#include "tests/shapes.h"
#include "tests/tiff_bytes.h"

// What a reader may take: memory of twice the file or what it unpacks to, whichever is larger, and 256 MB; two seconds
// of the processor and one more for each megabyte of that. Measured in a process that does nothing but read.

using namespace homolog;

namespace {

struct Measured {
  double bytes = 0, seconds = 0, kept = -1;
  std::string said;
};

/// Reads files one after the other in one process and measures each.
std::vector<Measured> read_in_a_child(const std::vector<fs::path>& files, const TemporaryFolder& folder,
                                      bool as_pictures = false) {
  std::string command = "'" HOMOLOG_READ_ONE_FILE "'" + std::string(as_pictures ? " --picture" : "");
  for (const fs::path& file : files) command += " '" + file.string() + "'";
  const fs::path out = folder.path / "measured";
  const int status = std::system((command + " > '" + out.string() + "' 2>&1").c_str());
  std::istringstream lines(read_whole_file(out).value());
  std::vector<Measured> all;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    Measured one;
    const bool measured = static_cast<bool>(words >> one.bytes >> one.seconds >> one.kept);
    CHECK_MESSAGE(measured, "a reader or its library printed: ", line);
    std::getline(words, one.said);
    all.push_back(one);
  }
  const std::string last = all.size() < files.size() ? files[all.size()].string() : "";
  REQUIRE_MESSAGE(status == 0, "the reader ended with status ", status, " at ", last);
  REQUIRE(all.size() == files.size());
  return all;
}

/// Reads the files and compares with the budget. `unpacked`: bytes that packed files really hold; `libraries`: bytes of
/// a module that is loaded for them.
std::vector<Measured> check_budget(const std::vector<fs::path>& files, const TemporaryFolder& folder,
                                   double unpacked = 0, bool as_pictures = false, double libraries = 0) {
  const auto all = read_in_a_child(files, folder, as_pictures);
  for (std::size_t k = 0; k < files.size(); ++k) {
    CAPTURE(files[k].string());
    CAPTURE(all[k].said);
    CAPTURE(all[k].kept);
    const double decoded = std::max({static_cast<double>(fs::file_size(files[k])), all[k].kept, unpacked});
    CHECK(all[k].bytes <= 2 * decoded + 256e6 + libraries);
    CHECK(all[k].seconds <= 2 + decoded / 1e6);
  }
  return all;
}

std::string zeros(std::size_t count) {
  return std::string(count, '\0');
}

std::string noise(std::size_t count) {
  std::mt19937 random(7);
  std::string bytes(count, '\0');
  for (char& byte : bytes) byte = static_cast<char>(random());
  return bytes;
}

std::string big_endian(std::uint32_t value, std::size_t bytes) {
  const std::string text = little_endian(value, bytes);
  return {text.rbegin(), text.rend()};
}

/// A gzip of `head`, then so many zeros.
void write_gzip(const fs::path& path, const std::string& head, std::size_t zero_bytes) {
  const gzFile file = gzopen(path.c_str(), "wb6");
  REQUIRE(file != nullptr);
  gzwrite(file, head.data(), static_cast<unsigned>(head.size()));
  const std::string some = zeros(1 << 20);
  for (std::size_t left = zero_bytes; left > 0;) {
    const std::size_t step = std::min(left, some.size());
    gzwrite(file, some.data(), static_cast<unsigned>(step));
    left -= step;
  }
  REQUIRE(gzclose(file) == Z_OK);
}

std::string nifti_header(int nx, int ny, int nz, float voxels_begin) {
  std::string h = zeros(352);
  const auto put = [&h](std::size_t at, const std::string& bytes) { h.replace(at, bytes.size(), bytes); };
  put(0, little_endian(348, 4));
  put(40, little_endian(3, 2));
  put(42, little_endian(static_cast<std::uint32_t>(nx), 2) + little_endian(static_cast<std::uint32_t>(ny), 2) +
              little_endian(static_cast<std::uint32_t>(nz), 2));
  put(70, little_endian(2, 2) + little_endian(8, 2));
  std::string number(sizeof(float), '\0');
  const auto put_float = [&](std::size_t at, float value) {
    std::memcpy(number.data(), &value, sizeof value);
    put(at, number);
  };
  for (std::size_t k = 0; k < 4; ++k) put_float(76 + 4 * k, 1);
  put_float(108, voxels_begin);
  put(344, "n+1");
  return h;
}

std::string png(std::uint32_t width, std::uint32_t height, int interlace, const std::string& pixels) {
  const auto chunk = [](const std::string& name, const std::string& data) {
    const std::string all = name + data;
    const auto sum =
        static_cast<std::uint32_t>(crc32(0, reinterpret_cast<const Bytef*>(all.data()), static_cast<uInt>(all.size())));
    return big_endian(static_cast<std::uint32_t>(data.size()), 4) + all + big_endian(sum, 4);
  };
  const std::string header =
      big_endian(width, 4) + big_endian(height, 4) + std::string{8, 0, 0, 0, static_cast<char>(interlace)};
  return "\x89PNG\r\n\x1a\n" + chunk("IHDR", header) + chunk("IDAT", pixels) + chunk("IEND", "");
}

std::string dicom_element(std::uint32_t group, std::uint32_t number, const std::string& kind, std::string value) {
  if (value.size() % 2 != 0) value += kind == "UI" ? '\0' : ' ';
  return little_endian(group, 2) + little_endian(number, 2) + kind +
         little_endian(static_cast<std::uint32_t>(value.size()), 2) + value;
}

/// One grey plane of 8 bits in a transfer syntax, its stream as one fragment.
std::string dicom(const std::string& syntax, std::uint32_t side, std::string stream) {
  if (stream.size() % 2 != 0) stream += '\0';
  const auto number = [](std::uint32_t value) { return little_endian(value, 2); };
  const std::string meta = dicom_element(2, 0x10, "UI", syntax);
  std::string body = dicom_element(8, 0x16, "UI", "1.2.840.10008.5.1.4.1.1.2") + dicom_element(8, 0x60, "CS", "CT") +
                     dicom_element(0x20, 0xe, "UI", "1.2") + dicom_element(0x20, 0x32, "DS", "0\\0\\0") +
                     dicom_element(0x20, 0x37, "DS", "1\\0\\0\\0\\1\\0") + dicom_element(0x28, 2, "US", number(1)) +
                     dicom_element(0x28, 4, "CS", "MONOCHROME2") + dicom_element(0x28, 0x10, "US", number(side)) +
                     dicom_element(0x28, 0x11, "US", number(side)) + dicom_element(0x28, 0x30, "DS", "1\\1");
  body += dicom_element(0x28, 0x100, "US", number(8)) + dicom_element(0x28, 0x101, "US", number(8)) +
          dicom_element(0x28, 0x102, "US", number(7)) + dicom_element(0x28, 0x103, "US", number(0));
  const auto item = [](std::uint32_t mark, std::uint32_t size) {
    return little_endian(0xfffe, 2) + little_endian(mark, 2) + little_endian(size, 4);
  };
  return zeros(128) + "DICM" + dicom_element(2, 0, "UL", little_endian(static_cast<std::uint32_t>(meta.size()), 4)) +
         meta + body + little_endian(0x7fe0, 2) + little_endian(0x10, 2) + "OB" + zeros(2) +
         little_endian(0xffffffff, 4) + item(0xe000, 0) + item(0xe000, static_cast<std::uint32_t>(stream.size())) +
         stream + item(0xe0dd, 0);
}

std::string jpeg_2000(std::uint32_t side, const std::string& data) {
  std::string siz = big_endian(41, 2) + zeros(2);
  for (const std::uint32_t n : {side, side, 0u, 0u, side, side, 0u, 0u}) siz += big_endian(n, 4);
  siz += big_endian(1, 2) + "\x07\x01\x01";
  return "\xff\x4f\xff\x51" + siz + "\xff\x52" + big_endian(12, 2) + std::string{0, 0, 0, 1, 0, 5, 4, 4, 0, 1} +
         "\xff\x5c" + big_endian(19, 2) + "\x40" + std::string(16, 'H') + "\xff\x90" + big_endian(10, 2) + zeros(6) +
         std::string{0, 1} + "\xff\x93" + data + "\xff\xd9";
}

std::string jpeg_ls(std::uint32_t side, const std::string& data) {
  return "\xff\xd8\xff\xf7" + big_endian(11, 2) + "\x08" + big_endian(side, 2) + big_endian(side, 2) +
         std::string{1, 1, 0x11, 0} + "\xff\xda" + big_endian(8, 2) + std::string{1, 1, 0, 0, 0, 0} + data + "\xff\xd9";
}

std::string repeated(const std::string& text, std::size_t count) {
  std::string all;
  all.reserve(text.size() * count);
  for (std::size_t k = 0; k < count; ++k) all += text;
  return all;
}

/// The file with numbers that claim much and with its end cut off.
std::vector<std::string> mutants_of(const std::string& whole) {
  std::vector<std::string> mutants;
  for (const std::size_t quarter : {1u, 2u, 3u}) mutants.push_back(whole.substr(0, whole.size() * quarter / 4));
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  std::size_t runs = 0;
  for (std::size_t at = 0; at < whole.size() && runs < 10; ++at) {
    if (!digit(whole[at]) || (at > 0 && digit(whole[at - 1]))) continue;
    std::size_t end = at;
    while (end < whole.size() && digit(whole[end])) ++end;
    mutants.push_back(whole.substr(0, at) + "999999999" + whole.substr(end));
    ++runs;
  }
  std::mt19937 random(11);
  for (int k = 0; k < 10 && whole.size() > 8; ++k) {
    std::string bytes = whole;
    const std::size_t at = random() % (std::min<std::size_t>(whole.size(), 400) - 4) / 2 * 2;
    bytes.replace(at, 4, k % 2 == 0 ? "\xff\xff\xff\x7f" : "\x7f\xff\xff\xff");
    mutants.push_back(bytes);
  }
  return mutants;
}

}  // namespace

TEST_CASE("mutants of every format are read or refused within the budget") {
  const TemporaryFolder folder;
  std::vector<fs::path> files;
  int made = 0;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(HOMOLOG_SOURCE_DIR) / "tests/fuzz/seeds")) {
    if (!entry.is_regular_file() || entry.path().parent_path().filename() == "json") continue;
    const std::string name = entry.path().filename().string();
    const std::string ending = name.substr(name.find('.'));
    for (const std::string& bytes : mutants_of(read_whole_file(entry.path()).value())) {
      files.push_back(folder.path / (std::to_string(made++) + ending));
      write_bytes(files.back(), bytes);
    }
  }
  CHECK(files.size() > 500);
  const auto all = check_budget(files, folder);
  const auto refused = std::count_if(all.begin(), all.end(), [](const Measured& one) { return one.kept < 0; });
  CHECK(refused > static_cast<std::ptrdiff_t>(files.size() / 2));
}

TEST_CASE("small files that claim much take little before it arrives") {
  const TemporaryFolder folder;
  const auto put = [&folder](const char* name, const std::string& bytes) {
    write_bytes(folder.path / name, bytes);
    return folder.path / name;
  };
  const std::string some_noise = noise(900'000), little_noise = repeated("abcdefgh", 6000);
  write_gzip(folder.path / "claims.nii.gz", nifti_header(1000, 1000, 900, 352), 60'000'000);
  {
    std::ofstream more(folder.path / "claims.nii.gz",
                       std::ios::app | std::ios::binary);  // so that the claim is possible
    more << some_noise;
  }
  check_budget({folder.path / "claims.nii.gz"}, folder, 60e6);
  write_gzip(folder.path / "far.nii.gz", nifti_header(4, 4, 4, 2.5e9F), 4'000'000);
  std::vector<fs::path> files{folder.path / "far.nii.gz"};
  files.push_back(put("row.png", png(30000, 30000, 0, deflated(zeros(1'000'000)) + some_noise)));
  files.push_back(put("interlaced.png", png(30000, 30000, 1, deflated(zeros(1'000'000)) + some_noise)));
  TiffBytes tiff;
  tiff.width = tiff.height = 30000;
  tiff.pages = {{some_noise}};
  for (const std::uint32_t method : {5u, 8u}) {
    tiff.compression = method;
    files.push_back(put(method == 5 ? "lzw.tif" : "zip.tif", tiff.bytes()));
  }
  tiff.width = tiff.height = 60000;
  tiff.bits = 1;
  tiff.compression = 4;
  tiff.pages = {{some_noise.substr(0, 50000)}};
  files.push_back(put("fax.tif", tiff.bytes()));
  files.push_back(put("j2k.dcm", dicom("1.2.840.10008.1.2.4.90", 20000, jpeg_2000(20000, little_noise))));
  files.push_back(put("jls.dcm", dicom("1.2.840.10008.1.2.4.80", 20000, jpeg_ls(20000, little_noise))));
  files.push_back(put("jls-small.dcm", dicom("1.2.840.10008.1.2.4.80", 5400, jpeg_ls(5400, little_noise))));
  files.push_back(
      put("rle.dcm", dicom("1.2.840.10008.1.2.5", 20000,
                           little_endian(1, 4) + little_endian(64, 4) + zeros(56) + repeated("\x81z", 24000))));
  for (const Measured& one : check_budget(files, folder)) CHECK(one.kept < 0);
  check_budget({folder.path / "row.png", folder.path / "interlaced.png"}, folder, 0, true);
  // A plane that decoders make something of, at the largest size that is believed. They come with the picture module.
  check_budget({put("j2k-small.dcm", dicom("1.2.840.10008.1.2.4.90", 5400, jpeg_2000(5400, little_noise)))}, folder, 0,
               false, 100e6);
}

TEST_CASE("text that unfolds in memory is read or refused within the budget") {
  const TemporaryFolder folder;
  const auto put = [&folder](const char* name, const std::string& bytes) {
    write_bytes(folder.path / name, bytes);
    return folder.path / name;
  };
  const std::string empty_arrays = "[" + repeated("[],", 5'000'000) + "[]]",
                    empty_objects = "[" + repeated("{},", 5'000'000) + "{}]",
                    digits = "[" + repeated("1,", 7'500'000) + "1]";
  std::vector<fs::path> files;
  for (const char* ending : {".mrk.json", ".h5.json", ".study.json", ".homolog"}) {
    files.push_back(put(("arrays" + std::string(ending)).c_str(), "{\"homolog\":" + empty_arrays + "}\n"));
    files.push_back(put(("objects" + std::string(ending)).c_str(), "{\"homolog\":" + empty_objects + "}\n"));
    files.push_back(put(("digits" + std::string(ending)).c_str(), "{\"homolog\":" + digits + "}\n"));
  }
  for (const Measured& one : check_budget(files, folder)) CHECK(one.kept < 0);
  std::vector<fs::path> meshes{put("fan.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf " + repeated("1 2 3 ", 2'500'000) + "\n")};
  std::string header =
      "ply\nformat binary_little_endian 1.0\nelement vertex 50000\nproperty float x\nproperty float y\nproperty float "
      "z\n";
  for (int k = 0; k < 600; ++k) header += "property uchar p" + std::to_string(k) + "\n";
  meshes.push_back(put("properties.ply", header +
                                             "element face 1\nproperty list uchar int vertex_indices\nend_header\n" +
                                             zeros(612 * 50000) + "\3" + little_endian(0, 4) + little_endian(1, 4) +
                                             little_endian(2, 4)));
  meshes.push_back(put("points.particles", repeated("1 2 3\n", 3'000'000)));
  std::string nodes, values;
  for (int k = 1; k <= 20'000; ++k) {
    nodes += std::to_string(k) + " 0 0 " + std::to_string(k) + "\n";
    values += "$NodeData\n1\n\"" + std::to_string(k) + "\"\n1\n0\n3\n0\n1\n1\n1 0\n$EndNodeData\n";
  }
  meshes.push_back(put("values.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n20000\n" + nodes +
                                         "$EndNodes\n$Elements\n1\n1 2 0 1 2 3\n$EndElements\n" + values));
  check_budget(meshes, folder);
}

TEST_CASE("real files that mean harm keep to the budget of every reader") {
  const fs::path data = real_data();
  if (data.empty()) return;
  const TemporaryFolder folder;
  std::vector<fs::path> files, models;
  for (const auto& entry : fs::directory_iterator(data / "hostile")) {
    const fs::path& path = entry.path();
    if (path.filename() == "nrrd_bzip2_claim_3GB.nrrd") continue;  // it holds 200 MB
    (path.extension() == ".h5" ? models : files).push_back(path);
  }
  CHECK(files.size() + models.size() > 30);
  check_budget(files, folder);
  check_budget(models, folder);
  check_budget({data / "hostile/nrrd_bzip2_claim_3GB.nrrd"}, folder, 200e6);
}
