#include <algorithm>
#include <map>

#include "tests/command_line.h"
#include "tests/must.h"

// homolog --integrate: the menu entry, the icon and the file types of a user, in a folder of data of the test's own.

namespace homolog {

namespace {

/// A home, with a copy of the program as the portable archive has it: a script, and the program in lib/.
struct IntegratedHome {
  TemporaryFolder folder;
  fs::path archive = folder.path / "it's $5 \"here\"";
  fs::path data = folder.path / "home/share";

  IntegratedHome() {
    fs::create_directories(archive / "lib");
    fs::copy_file(HOMOLOG_PROGRAM, archive / "lib/homolog");
    fs::copy_file(HOMOLOG_SOURCE_DIR "/packaging/launcher.sh", archive / "homolog");
  }
  Ran integrate(const std::string& more = "", const std::string& program = HOMOLOG_PROGRAM) const {
    std::string quoted;
    for (const char letter : program) quoted += letter == '\'' ? "'\\''" : std::string(1, letter);
    return run(folder,
               "--version >/dev/null && XDG_DATA_HOME='" + data.string() + "' '" + quoted + "' --integrate " + more);
  }
  /// What the folder of data holds without what the system's tools keep there.
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    if (!fs::exists(data)) return names;
    for (const auto& entry : fs::recursive_directory_iterator(data)) {
      const std::string name = fs::relative(entry.path(), data).string();
      const bool own = name.find("homolog") != std::string::npos && name.find("mime/application") == std::string::npos;
      if (entry.is_regular_file() && own) names.push_back(name);
    }
    std::ranges::sort(names);
    return names;
  }
  std::string text(const std::string& name) const { return read_whole_file(data / name).value_or(""); }
};

const std::vector<std::string> all_files{"applications/homolog.desktop", "homolog/integrated.json",
                                         "icons/hicolor/scalable/apps/homolog.svg", "mime/packages/homolog.xml",
                                         "thumbnailers/homolog.thumbnailer"};

/// Whether the system has a tool; where it lacks it, the part of the test is skipped.
bool has_tool(const std::string& tool) {
  if (std::system(("command -v " + tool + " >/dev/null").c_str()) == 0) return true;
  test::skip(tool + " is not installed");
  return false;
}

}  // namespace

TEST_CASE("a program without a package gets a menu entry and an icon and file types and gives all of them back") {
  const IntegratedHome home;
  for (int again = 0; again < 2; ++again) {  // once more does no harm
    const Ran ran = home.integrate();
    INFO(ran.errors);
    REQUIRE(ran.status == 0);
    CHECK(home.files() == all_files);
  }
  const std::string entry = home.text("applications/homolog.desktop");
  CHECK(entry.find("\nExec=\"" HOMOLOG_PROGRAM "\" %F\n") != std::string::npos);
  CHECK(entry.find("\nTryExec=" HOMOLOG_PROGRAM "\n") != std::string::npos);
  CHECK(home.text("mime/packages/homolog.xml") ==
        test::must(read_whole_file(HOMOLOG_SOURCE_DIR "/assets/homolog-mime.xml")));
  // A stranger's file that lies beside stays, and a folder with it.
  REQUIRE(write_whole_file(home.data / "thumbnailers/other.thumbnailer", "other"));
  const Ran back = home.integrate("remove");
  REQUIRE(back.status == 0);
  CHECK(home.files().empty());
  CHECK(fs::exists(home.data / "thumbnailers/other.thumbnailer"));
  CHECK_FALSE(fs::exists(home.data / "icons"));
  CHECK(home.integrate("remove").status == 0);
}

TEST_CASE("the menu entry of the portable archive starts its script also from a folder with odd letters") {
  const IntegratedHome home;
  const std::string script = (home.archive / "homolog").string();
  const Ran ran = home.integrate("", (home.archive / "lib/homolog").string());
  INFO(ran.errors);
  REQUIRE(ran.status == 0);
  const std::string entry = home.text("applications/homolog.desktop");
  CHECK(entry.find("\nTryExec=" + script + "\n") != std::string::npos);
  CHECK(entry.find(R"(/it's \\$5 \\"here\\"/homolog" %F)") != std::string::npos);
  if (has_tool("desktop-file-validate"))
    CHECK(std::system(
              ("desktop-file-validate '" + (home.data / "applications/homolog.desktop").string() + "'").c_str()) == 0);
}

TEST_CASE("the desktop opens cases with the program that was integrated last") {
  const IntegratedHome home;
  if (!has_tool("update-desktop-database") || !has_tool("xdg-mime")) return;
  REQUIRE(home.integrate().status == 0);
  const auto opener = [&](const char* type) {
    return run(home.folder, "--version >/dev/null && XDG_DATA_DIRS=/nowhere XDG_CONFIG_HOME=/nowhere XDG_DATA_HOME='" +
                                home.data.string() + "' xdg-mime query default application/x-homolog-" + type)
        .out;
  };
  CHECK(opener("case") == "homolog.desktop\n");
  CHECK(opener("study") == "homolog.desktop\n");
  REQUIRE(home.integrate("remove").status == 0);
  CHECK(opener("case") == "");
}

TEST_CASE("files that another wrote or changed are neither replaced nor taken away") {
  const IntegratedHome home;
  fs::create_directories(home.data / "applications");
  const fs::path entry = home.data / "applications/homolog.desktop";
  REQUIRE(write_whole_file(entry, "mine"));
  check_refused(home.integrate(), "move it away first");
  CHECK(home.files() == std::vector<std::string>{"applications/homolog.desktop"});
  fs::remove(entry);
  REQUIRE(home.integrate().status == 0);
  REQUIRE(write_whole_file(entry, "changed"));
  check_refused(home.integrate(), "was changed since");
  const Ran back = home.integrate("remove");
  CHECK(back.status == 0);
  CHECK(back.errors.find("homolog.desktop: was changed since, and stays") != std::string::npos);
  CHECK(home.files() == std::vector<std::string>{"applications/homolog.desktop"});
}

TEST_CASE("where the folder of data cannot be written --integrate says so and with other words it is refused") {
  const IntegratedHome home;
  REQUIRE(write_whole_file(home.folder.path / "home", "a file"));
  check_refused(home.integrate(), (home.folder.path / "home").string());
  for (const char* more : {"please", "remove info a.ply"}) CHECK(home.integrate(more).status == 2);
  CHECK(run(home.folder, "--log a.log --integrate").status == 2);
}

}  // namespace homolog
