#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <random>
#include <set>

#include "core/base/pictures/picture_io.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/files/mesh_frame.h"
#include "core/mesh/mesh_io.h"
#include "core/model/files/statismo.h"
#include "core/volume/volume_io.h"
#include "tests/command_line.h"
#include "tests/real_data.h"
#include "tests/shapes.h"
#include "tests/tiff_bytes.h"

using namespace homolog;

namespace {

std::set<std::string> names_in(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename().string());
  names.erase("stderr");
  return names;
}

/// Meshes and a label map of noise, none of which fits into a few kilobytes, packed or not.
void put_inputs(const fs::path& folder) {
  for (int k = 1; k <= 3; ++k) {
    Mesh ball = icosphere(4, 40);
    for (Eigen::Index i = 0; i < ball.points.rows(); ++i)
      ball.points(i, i % 3) *= 1 + 0.01 * static_cast<double>((i * k) % 7);
    REQUIRE(write_mesh(ball, folder / ("ball-" + std::to_string(k) + ".ply")));
  }
  Volume volume;
  volume.geometry.dims = {24, 24, 24};
  std::vector<std::uint8_t> voxels(24 * 24 * 24);
  std::mt19937 random(1);
  for (auto& voxel : voxels) voxel = static_cast<std::uint8_t>(random() % 256);
  volume.data = voxels;
  REQUIRE(write_volume(volume, folder / "noise.nii"));
}

struct Use {
  double seconds = 0;  ///< of the processor, its children's too
  long most_megabytes = 0;
  int status = 0;
  std::string errors;
};

/// Runs the program without a shell, so that the system counts its memory and time and nothing else's. No process of it
/// gets more than `most_seconds` of the processor.
Use used_by(const std::vector<std::string>& arguments, const TemporaryFolder& folder,
            rlim_t most_seconds = RLIM_INFINITY) {
  const fs::path errors = folder.path / "errors";
  const pid_t process = ::fork();
  REQUIRE(process >= 0);
  if (process == 0) {
    std::vector<char*> argv{const_cast<char*>(HOMOLOG_PROGRAM)};
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    if (std::freopen("/dev/null", "w", stdout) == nullptr || std::freopen(errors.c_str(), "w", stderr) == nullptr)
      ::_exit(126);
    ::alarm(60);
    const rlimit processor{most_seconds, most_seconds};
    ::setrlimit(RLIMIT_CPU, &processor);
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  Use use;
  rusage resources{};
  REQUIRE(::wait4(process, &use.status, 0, &resources) == process);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  use.seconds = seconds(resources.ru_utime) + seconds(resources.ru_stime);
  use.most_megabytes = resources.ru_maxrss / 1024;
  use.status = WIFEXITED(use.status) ? WEXITSTATUS(use.status) : 128 + WTERMSIG(use.status);
  use.errors = read_whole_file(errors).value_or("");
  return use;
}

}  // namespace

TEST_CASE("on a full disk every writer says so and keeps the old file") {
  const TemporaryFolder folder;
  put_inputs(folder.path);
  const std::string balls = "ball-1.ply ball-2.ply ball-3.ply";
  const std::vector<std::pair<std::string, std::string>> writers{
      {"convert ball-1.ply old.ply", "old.ply"},
      {"convert ball-1.ply old.vtk", "old.vtk"},
      {"convert ball-1.ply old.vtp", "old.vtp"},
      {"convert ball-1.ply old.obj", "old.obj"},
      {"convert ball-1.ply old.stl", "old.stl"},
      {"convert ball-1.ply old.particles", "old.particles"},
      {"convert noise.nii old.nii", "old.nii"},
      {"convert noise.nii old.nii.gz", "old.nii.gz"},
      {"convert noise.nii old.nrrd", "old.nrrd"},
      {"convert noise.nii old.mha", "old.mha"},
      {"mirror ball-1.ply -o old-mirror.ply", "old-mirror.ply"},
      {"picture correspondence " + balls + " -o old.png", "old.png"},
      {"picture correspondence " + balls + " -o old.tif", "old.tif"},
      {"picture correspondence " + balls + " -o old.jpg", "old.jpg"},
      {"model " + balls + " -o old.h5", "old.h5"},
      {"model " + balls + " -o old.h5.json", "old.h5.json"}};
  for (const auto& [arguments, file] : writers) std::ofstream(folder.path / file) << "the old one";
  const auto before = names_in(folder.path);
  for (const auto& [arguments, file] : writers) {
    CAPTURE(arguments);
    const Ran ran = run_on_full_disk(folder, arguments, 4096);
    check_refused(ran, file);
    CHECK(ran.errors.find("cannot be written") != std::string::npos);
    CHECK(read_whole_file(folder.path / file).value() == "the old one");
    CHECK(names_in(folder.path) == before);
  }
}

TEST_CASE("a case that a scripted user works on appears whole or not at all") {
  const TemporaryFolder folder;
  REQUIRE(run(folder, "phantom kidney --subject 2 -o .").status == 0);
  const std::string work = "study user built-in:kidney --mask kidney-2-labels.nii.gz --pulls 4 -o work.homolog";
  std::ofstream(folder.path / "work.homolog") << "the old one";
  check_refused(run_on_full_disk(folder, work, 512), "work.homolog");
  CHECK(read_whole_file(folder.path / "work.homolog").value() == "the old one");
  REQUIRE(run(folder, work).status == 0);
  CHECK(run(folder, "replay work.homolog -o work.ply --json").json()["strokes"] == 4);
}

TEST_CASE("a demo that the disk cannot hold leaves no case") {
  const TemporaryFolder folder;
  check_refused(run_on_full_disk(folder, "demo --headless -o new/out", 4096), "cannot be written");
  CHECK(names_in(folder.path).empty());
}

TEST_CASE("a run that fails leaves no folder") {
  const TemporaryFolder folder;
  put_inputs(folder.path);
  const auto before = names_in(folder.path);
  const std::string model = "model ball-1.ply ball-2.ply ball-3.ply -o m.h5 ";
  for (const std::string& arguments :
       {model + "--csv new/e", model + "--aligned new/e", std::string("phantom kidney --subject 1 -o new/d"),
        std::string("fit ball-1.ply --mesh absent-1.ply absent-2.ply -o new/d"),
        std::string("study schemes ball-1.ply --mesh absent.ply -o new/d")}) {
    CAPTURE(arguments);
    const Ran ran = run_on_full_disk(folder, arguments, 512);
    INFO(ran.out);
    CHECK(ran.status == 1);
    CHECK(names_in(folder.path) == before);
  }
}

TEST_CASE("what a verb reads is not written over and what has no effect on a model is refused") {
  const TemporaryFolder folder;
  fs::create_directory(folder.path / "a");
  for (const char* name : {"a/one.ply", "a/two.ply", "t.ply"})
    REQUIRE(write_mesh(icosphere(2, name[2] == 'o' ? 20 : 21), folder.path / name));
  const std::string before = read_whole_file(folder.path / "a/one.ply").value();
  check_refused(run(folder, "fit t.ply --mesh a -o a"), "a/one.ply");
  CHECK(read_whole_file(folder.path / "a/one.ply").value() == before);
  CHECK(run(folder, "fit t.ply --mesh a/one.ply --by-others 2 -o o.ply").status == 2);

  REQUIRE(run(folder, "model a/one.ply a/two.ply --no-align -o m.h5.json").status == 0);
  for (const char* option : {"--times 1000", "--from-ras", "--spacing 1,1,1", "--like a/one.ply"})
    check_refused(run(folder, std::string("convert m.h5.json mean.ply ") + option), "m.h5.json: is a model");
  CHECK(run(folder, "convert m.h5.json mean.ply").status == 0);

  // A mesh keeps to the frame that it notes: 9 is not in this image.
  Volume image;
  image.geometry.dims = {8, 8, 8};
  image.frames = 2;
  image.data = std::vector<std::int16_t>(2 * image.geometry.voxels());
  image.range_max = 1;
  REQUIRE(write_volume(image, folder.path / "cine.nii.gz"));
  MeshFile noted = read_mesh_file(folder.path / "t.ply").value();
  note_frame(noted, 9);
  REQUIRE(write_mesh_file(noted, folder.path / "noted.ply"));
  const Ran beyond = run(folder, "snap noted.ply --image cine.nii.gz -o s.ply");
  CHECK(beyond.status == 1);
  CHECK(beyond.errors.find("frame") != std::string::npos);
}

TEST_CASE("copies of one surface at one place do not hang the program") {
  const TemporaryFolder folder;
  const Mesh one = shapes::tetrahedron(10);
  MeshFile copies;
  constexpr int times = 5000;
  copies.points = one.points.replicate(times, 1);
  Triangles& faces = copies.triangles.edit();
  faces.resize(4 * times, 3);
  for (int k = 0; k < times; ++k) faces.middleRows(4 * k, 4) = one.topology->triangles().array() + 4 * k;
  REQUIRE(write_mesh_file(copies, folder.path / "v.vtp"));
  const std::string in = (folder.path / "v.vtp").string(), out = (folder.path / "o.ply").string();
  for (const auto& arguments :
       {std::vector<std::string>{"info", in}, {"convert", in, out}, {"template", in, "-o", out}}) {
    CAPTURE(arguments.front());
    const Use use = used_by(arguments, folder);
    CHECK(use.status == 0);   // a template makes one of them
    CHECK(use.seconds < 10);  // 200 and more when every pair was compared
  }
  const Ran info = run(folder, "info v.vtp --json");
  CHECK(info.json()["self_intersections"] == 100000);
  CHECK(info.json()["self_intersections_all"] == false);
  CHECK(info.errors.find("v.vtp: so many of its faces cut") != std::string::npos);
}

TEST_CASE("a write-protected file and a link that leads nowhere are no place for a result") {
  const TemporaryFolder folder;
  put_inputs(folder.path);
  std::ofstream(folder.path / "atlas.ply") << "the old one";
  REQUIRE(::chmod((folder.path / "atlas.ply").c_str(), 0444) == 0);
  fs::create_symlink("absent.ply", folder.path / "link.ply");
  check_refused(run(folder, "mirror ball-1.ply -o atlas.ply"), "atlas.ply: is write-protected");
  check_refused(run(folder, "mirror ball-1.ply -o link.ply"), "link.ply: is a link to absent.ply");
  CHECK(read_whole_file(folder.path / "atlas.ply").value() == "the old one");
  CHECK(fs::is_symlink(folder.path / "link.ply"));
}

TEST_CASE("points that may have been cut off are refused alone and named in a training set") {
  const TemporaryFolder folder;
  put_inputs(folder.path);
  for (int k = 1; k <= 3; ++k) {
    const std::string name = "ball-" + std::to_string(k);
    REQUIRE(
        write_mesh_file(read_mesh_file(folder.path / (name + ".ply")).value(), folder.path / (name + ".particles")));
  }
  const std::string whole = read_whole_file(folder.path / "ball-3.particles").value();
  write_bytes(folder.path / "ball-3.particles", whole.substr(0, whole.size() - 1));
  const std::string points = std::to_string(icosphere(4, 40).points.rows()) + " points";
  check_refused(run(folder, "info ball-3.particles"), "add a line break at its end if it is whole");
  check_refused(run(folder, "convert ball-3.particles out.particles"),
                "ball-3.particles: ends without a line break after " + points);
  CHECK_FALSE(fs::exists(folder.path / "out.particles"));
  const Ran model = run(folder, "model ball-1.particles ball-2.particles ball-3.particles -o m.h5");
  CHECK(model.status == 0);
  CHECK(model.errors.find("ball-3.particles: ends without a line break after " + points) != std::string::npos);
  write_bytes(folder.path / "ball-3.particles", whole.substr(0, whole.find('\n', whole.size() / 2)));
  check_refused(run(folder, "model ball-1.particles ball-2.particles ball-3.particles -o m.h5"), "ball-3.particles");
}

TEST_CASE("a warning names the file that it is about") {
  const TemporaryFolder folder;
  REQUIRE(write_mesh(icosphere(3, 20), folder.path / "long.ply"));
  std::ofstream(folder.path / "long.ply", std::ios::app | std::ios::binary) << "more";
  for (const char* arguments : {"info long.ply", "convert long.ply out.vtk", "mirror long.ply -o out.ply",
                                "template long.ply -o out.ply --vertices 200"}) {
    CAPTURE(arguments);
    const Ran ran = run(folder, arguments);
    CHECK(ran.status == 0);
    CHECK(ran.errors.starts_with("homolog: warning: long.ply: the file holds more than its header announces"));
  }
  std::ofstream obj(folder.path / "two.obj");
  for (int k = 0; k < 2; ++k) {
    const Mesh ball = icosphere(2, 20 - 10.0 * k);
    for (const auto p : ball.points.rowwise()) obj << "v " << p[0] + 50 * k << ' ' << p[1] << ' ' << p[2] << '\n';
    for (const auto f : ball.topology->triangles().rowwise())
      obj << "f " << f[0] + 1 + 162 * k << ' ' << f[1] + 1 + 162 * k << ' ' << f[2] + 1 + 162 * k << '\n';
  }
  obj.close();
  const Ran two = run(folder, "template two.obj -o out.ply --vertices 200");
  CHECK(two.errors.find("warning: two.obj: the surface has 2 parts") != std::string::npos);
  fs::create_directory(folder.path / "d.ply");
  check_refused(run(folder, "info d.ply"), "d.ply: is a folder, not a file; give the name of a file in it");
}

TEST_CASE("a device is no place for a result") {
  const TemporaryFolder folder;
  put_inputs(folder.path);
  REQUIRE(::mkfifo((folder.path / "pipe.ply").c_str(), 0600) == 0);
  check_refused(run(folder, "convert ball-1.ply pipe.ply"), "device or a pipe");
  CHECK(fs::is_fifo(folder.path / "pipe.ply"));
  for (const char* extension : {".ply", ".h5", ".h5.json", ".mrk.json", ".homolog", ".study.json"}) {
    const std::string name = std::string("in") + extension;
    REQUIRE(::mkfifo((folder.path / name).c_str(), 0600) == 0);
    const std::string verb = name == "in.study.json" ? "model " + name + " -o m.h5" : "info " + name;
    check_refused(run(folder, verb, "timeout 20 "), "device or a pipe");
  }
}

TEST_CASE("names in a file cannot write to the terminal") {
  const TemporaryFolder folder;
  const std::string position = R"(","position":[0,0,0]})", escape = R"(\u001b[31m\nhomolog: fine)";
  const auto put = [&](const std::string& name, const std::string& first, const std::string& second) {
    std::ofstream(folder.path / name) << R"({"markups":[{"controlPoints":[{"label":")" << first << position
                                      << R"(,{"label":")" << second << position << "]}]}";
  };
  put("same.mrk.json", escape, escape);
  put("long.mrk.json", std::string(5000000, 'n'), std::string(5000000, 'n'));
  put("names.mrk.json", escape, "b");
  const Ran same = run(folder, "info same.mrk.json"), longer = run(folder, "info long.mrk.json");
  check_refused(same, "two points named");
  check_refused(longer, "5000000 bytes");
  CHECK(longer.errors.size() < 500);
  const Ran names = run(folder, "info names.mrk.json");
  CHECK(names.status == 0);
  for (const std::string& text : {same.errors, names.out}) CHECK(text.find('\x1b') == std::string::npos);
  CHECK(names.out.find("\nhomolog: fine") == std::string::npos);
}

TEST_CASE("real files that mean harm are refused or read rightly in little time and memory") {
  const fs::path data = real_data();
  if (data.empty()) return;
  if (!fs::is_directory(data / "hostile")) {
    MESSAGE("skipped: no folder ", (data / "hostile").string());
    return;
  }
  const TemporaryFolder folder;
  int files = 0;
  for (const auto& entry : fs::directory_iterator(data / "hostile")) {
    const std::string name = entry.path().filename().string();
    const auto ends = [&](const char* ending) { return name.ends_with(ending); };
    if (!ends(".homolog") && !ends(".json") && !ends(".h5") && !ends(".ply") && !ends(".vtp")) continue;
    CAPTURE(name);
    const std::string out = (folder.path / "out.h5").string();
    const Use use = ends(".study.json") ? used_by({"model", entry.path().string(), "-o", out}, folder)
                                        : used_by({"info", entry.path().string()}, folder,
                                                  ends(".h5") ? 1 : RLIM_INFINITY);  // one is read for ever
    INFO(use.errors);
    CHECK((use.status == 0 || use.status == 1));
    if (use.status == 1) {
      CHECK(use.errors.starts_with("homolog: " + entry.path().string() + ": "));
      CHECK(lines(use.errors) == 1);
    }
    CHECK(use.seconds < 2);
    CHECK(use.most_megabytes < 512);
    ++files;
  }
  CHECK(files > 15);
}

TEST_CASE("an option that has no effect on its input is said") {
  const TemporaryFolder folder;
  put_inputs(folder.path);
  check_refused(run(folder, "info ball-1.ply --spacing 1,1,1"), "--spacing has no effect");
  check_refused(run(folder, "convert ball-1.ply out.ply --spacing 1,1,1"), "--spacing has no effect");
  check_refused(run(folder, "convert noise.nii out.nii --series 1.2"), "--series has no effect");
  check_refused(run(folder, "template ball-1.ply -o out.ply --label 2"), "--facing and --open-at have no effect");
  check_refused(run(folder, "convert ball-1.ply out.off"), "out.off: is not a kind of mesh that can be written");
  for (const char* work : {"model ball-1.ply absent.ply -o no/m.h5", "evaluate ball-1.ply absent.ply --csv no/e.csv",
                           "report absent.ply -o no/r.html", "template absent.ply -o no/t.ply"})
    check_refused(run(folder, work), "because its folder is not there");  // before anything is read
  fs::create_directory(folder.path / "scans");
  fs::copy(folder.path / "noise.nii", folder.path / "scans/noise.nii");
  check_refused(run(folder, "info scans"), "scans: is a folder, and no single masks lie in it, since noise.nii holds");
  CHECK(run(folder, "snap ball-1.ply --image noise.nii -o out.ply --sigma-mm 3").status == 2);
  CHECK(run(folder, "snap ball.homolog --frame 1").status == 2);
  CHECK(!fs::exists(folder.path / "out.ply"));
  const Ran own = run(folder, "convert noise.nii out.nii --spacing 1,1,1");
  CHECK(own.status == 0);
  CHECK(own.errors.find("warning: noise.nii: has a spacing of its own") != std::string::npos);
}

TEST_CASE("an option that has no effect on what a verb is given is said") {
  const TemporaryFolder folder;
  put_inputs(folder.path);
  const std::string balls = " ball-1.ply ball-2.ply ball-3.ply ";
  for (const std::string option :
       {"--reach-mm 3", "--strength 0.5", "--polarity either", "--done ball-1.ply noise.nii"}) {
    CAPTURE(option);
    const Ran ran = run(folder, "fit ball-1.ply --mesh ball-2.ply -o out.ply " + option);
    CHECK(ran.status == 2);
    CHECK(ran.errors.find(option.substr(0, option.find(' ')) + ": has no effect here: it is for an --image") !=
          std::string::npos);
  }
  for (const char* arguments :
       {"fit ball-1.ply --mesh ball-2.ply -o out.ply --frame 1",
        "fit ball-1.ply --mesh ball-2.ply -o out.ply --placement p.json --orientation any",
        "fit ball-1.ply --image noise.nii --placement p.json -o out.ply --orientation any",
        "fit ball-1.ply --image noise.nii --placement p.json --landmarks l.json -o out.ply",
        "replay ball.homolog -o out.ply --scheme raw --events 3", "repair-mesh ball-1.ply -o out.ply --vertices 500",
        "template --consensus ball-1.ply ball-2.ply -o out.ply --opening-mm 3",
        "template noise.nii --tube -o out.ply --vertices 900", "template noise.nii --tube -o out.ply --closing-mm 3",
        "template noise.nii --tube -o out.ply --opening-mm 3", "template noise.nii --tube -o out.ply --genus 1"}) {
    CAPTURE(arguments);
    const Ran ran = run(folder, arguments);
    CHECK(ran.status == 2);
    CHECK(ran.errors.find("has no effect here") != std::string::npos);
  }
  CHECK(run(folder, "bench --editor --mesh ball-1.ply").status == 2);
  check_refused(run(folder, "study bias" + balls + "--label 2"), "--label, --frame and --closing-mm have no effect");
  check_refused(run(folder, "study bias" + balls + "--closing-mm 2"),
                "--label, --frame and --closing-mm have no effect");
  for (const char* option : {"--label 2", "--frame 1"})
    check_refused(run(folder, "template --consensus" + balls + "-o out.ply " + option),
                  "--label, --frame and --closing-mm");
  for (const char* verb : {"model", "evaluate", "measure", "landmarks"}) {
    CAPTURE(verb);
    const std::string out = verb == std::string("model")       ? "-o out.h5"
                            : verb == std::string("landmarks") ? "-o out.tps --vertices"
                                                               : "";
    check_refused(run(folder, verb + balls + "--all-frames " + out), "--all-frames has no effect");
  }
  CHECK(!fs::exists(folder.path / "out.ply"));
}

TEST_CASE("what is no number is no number for every verb") {
  const TemporaryFolder folder;
  for (const char* option : {"evaluate --seed", "study user --seed", "study schemes --seed", "fit --reach-mm",
                             "fit --closing-mm", "replay --spacing", "template --vertices",
                             "picture case --glyph-spacing", "propagate --reach-mm", "snap --strength"}) {
    CAPTURE(option);
    for (const char* number : {"''", "nan", "inf", "1e999", "3x"}) {
      const Ran ran = run(folder, std::string(option) + " " + number);
      CAPTURE(ran.errors);
      CHECK(ran.status == 2);
      CHECK(ran.errors.find("is required") == std::string::npos);
    }
  }
}

TEST_CASE("a file that is not there has the status of data whichever option names it") {
  const TemporaryFolder folder;
  put_inputs(folder.path);
  const std::string of_spine = " --templates built-in:spine -o out";
  for (const auto& [arguments, absent] : std::vector<std::pair<std::string, std::string>>{
           {"score ball-1.ply --model absent.h5", "absent.h5"},
           {"score noise.nii --model absent.h5 --landmarks absent.json --template ball-1.ply", "absent.json"},
           {"picture score ball-1.ply --model absent.h5 -o p.svg", "absent.h5"},
           {"tets absent.vtu ball-1.ply --template ball-1.ply -o out", "absent.vtu"},
           {"test ball-1.ply --formula 'shape ~ size' --without-direction ball-1.ply absent.ply", "absent.ply"},
           {"repair noise.nii --image absent.nii" + of_spine, "absent.nii"},
           {"repair noise.nii --model absent.h5" + of_spine, "absent.h5"}}) {
    CAPTURE(arguments);
    check_refused(run(folder, arguments), absent + ": does not exist");
    CHECK_FALSE(fs::exists(folder.path / "out"));
  }
}

TEST_CASE("what makes no sense on any data has the status of a wrong command line") {
  const TemporaryFolder folder;
  put_inputs(folder.path);
  const std::string each = " ball-1.ply --structures a,b --alignment each --no-align";
  for (const auto& [arguments, says] : std::vector<std::pair<std::string, std::string>>{
           {"test ball-1.ply --formula 'shape ~'", "--formula: lacks a name at its end"},
           {"test ball-1.ply --formula 'size ~ size'", "--formula: has size on both sides of the ~"},
           {"model" + each + " -o m.h5", "--alignment each: aligns each structure on its own"},
           {"evaluate" + each, "--alignment each"},
           {"report" + each + " -o p.html", "--alignment each"}}) {
    CAPTURE(arguments);
    const Ran ran = run(folder, arguments);
    INFO(ran.errors);
    CHECK(ran.status == 2);
    CHECK(lines(ran.errors) == 1);
    CHECK(ran.errors.find(says) != std::string::npos);
  }
}

TEST_CASE("the picture module is loaded from the folder of the program alone") {
  const TemporaryFolder folder;
  const fs::path built = fs::path(HOMOLOG_PROGRAM).parent_path(), bin = folder.path / "bin";
  constexpr const char* module = "homolog_pictures.so";
  fs::create_directory(bin);
  fs::copy_file(HOMOLOG_PROGRAM, bin / "homolog");
  fs::copy_file(built / module, folder.path / module);
  TiffBytes slice;
  slice.pages = {{std::string(8, 'a')}};
  write_bytes(folder.path / "slice.tif", slice.bytes());
  const std::string read = "--version >/dev/null && bin/homolog info slice.tif --spacing 1,1,1";
  check_refused(run(folder, read), "cannot be loaded (not found)");
  fs::rename(folder.path / module, bin / module);
  CHECK(run(folder, read).status == 0);
}

TEST_CASE("the sample is a heart with its label map and its licence") {
  const TemporaryFolder folder;
  REQUIRE(run(folder, "sample -o s").status == 0);
  const Json image = run(folder, "info s/heart.nii.gz --json").json(),
             labels = run(folder, "info s/heart-labels.nii.gz --json").json();
  CHECK(image["dims"] == Json({128, 128, 12}));
  for (const char* key : {"dims", "spacing_mm", "origin_mm", "direction"}) CHECK(image[key] == labels[key]);
  CHECK(labels["range"] == Json({0.0, 2.0}));
  const Json cine = run(folder, "info s/heart-cine.nii.gz --json").json();
  CHECK(cine["frames"] == 20);
  CHECK(cine["frame_seconds"] == doctest::Approx(0.0375));
  for (const char* name : {"heart-cine-labels", "heart-cine-end-systole-labels"}) {
    const Json map = run(folder, "info s/" + std::string(name) + ".nii.gz --json").json();
    for (const char* key : {"dims", "spacing_mm", "origin_mm", "direction"}) CHECK(cine[key] == map[key]);
  }
  CHECK(read_whole_file(folder.path / "s/heart-licence.txt").value().find("CC0") != std::string::npos);
  const Ran fit = run(folder, "fit built-in:ventricle --mask s/heart-labels.nii.gz --label 1 -o v.ply --json");
  CHECK(fit.json()["dice"] > 0.98);
}
