#include <sys/resource.h>
#include <sys/stat.h>

#include "tests/command_line.h"
#include "tests/real_data.h"
#include "tests/tiff_bytes.h"

// Images through the program: a refusal is one line and exit 1, whatever the file.
using namespace homolog;

namespace {

/// `info` and `convert` of a file, ended after 30 s; a crash or a time-out is no refusal.
void check_image_refused(const TemporaryFolder& folder, const fs::path& file) {
  CAPTURE(file.string());
  const std::string program = "'" HOMOLOG_PROGRAM "'";
  for (const std::string& verb : {"info '" + file.string() + "' --spacing 1,1,1 --json",
                                  "convert '" + file.string() + "' out.nrrd --spacing 1,1,1"}) {
    CAPTURE(verb);
    const Ran ran = run(folder, "--version >/dev/null && timeout 30 " + program + " " + verb);
    check_refused(ran, file.filename().string());
    CHECK(!fs::exists(folder.path / "out.nrrd"));
  }
}

}  // namespace

TEST_CASE("the program refuses hostile image files in one line and does not take the memory they claim") {
  const fs::path data = real_data();
  if (data.empty()) return;
  const TemporaryFolder folder;
  for (const auto& entry : fs::directory_iterator(data / "hostile")) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("dicom_") || name.starts_with("nrrd_") || name.starts_with("tiff_"))
      check_image_refused(folder, entry.path());
  }
  rusage children{};
  ::getrusage(RUSAGE_CHILDREN, &children);
  CHECK(children.ru_maxrss < 800 * 1024);  // kB
}

TEST_CASE("the program refuses damaged and mislabelled images that are made here") {
  const TemporaryFolder folder;
  const auto check = [&](const std::string& name, const std::string& bytes) {
    write_bytes(folder.path / name, bytes);
    check_image_refused(folder, folder.path / name);
  };
  TiffBytes tiff;
  tiff.pages = {{"abcdefgh"}, {"ijklmnop"}};
  const std::string whole = tiff.bytes();
  check("cut.tif", whole.substr(0, whole.size() - 1));
  check("cut pages.tif", whole.substr(0, whole.size() / 2 + 20));
  check("jpeg.tif", "\xff\xd8\xff\xe0" + std::string(100, 'x'));
  check("upper.PNG", "\x89PNG\r\n\x1a\n" + std::string(100, 'x'));
  check("format.nhdr",
        "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 4 4\nencoding: raw\ndata file: %3000d.raw 1 4 1\n");
  REQUIRE(::mkfifo((folder.path / "pipe.nii").c_str(), 0600) == 0);
  check_image_refused(folder, folder.path / "pipe.nii");
}
