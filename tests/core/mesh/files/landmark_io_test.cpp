#include "core/mesh/files/landmark_io.h"

#include <doctest/doctest.h>
#include <unistd.h>

#include <fstream>

using namespace homolog;
namespace fs = std::filesystem;

namespace {

struct LandmarkFolder {
  fs::path path = fs::temp_directory_path() / ("homolog-landmarks-" + std::to_string(::getpid()));
  LandmarkFolder() { fs::create_directories(path); }
  ~LandmarkFolder() { fs::remove_all(path); }

  fs::path file(const char* name, const std::string& text) const {
    std::ofstream(path / name) << text;
    return path / name;
  }
  std::string refusal(const std::string& text) const {
    const auto read = read_landmarks(file("bad.json", text));
    return read ? "" : read.error().what;
  }
};

const std::vector<Landmark> two_poles{{"superior pole", Vec3(1.25, -2.5, 0.1)},
                                      {"untere Öffnung", Vec3(1e-3, 7, -300)}};

}  // namespace

TEST_CASE("landmarks survive a round trip through the files of 3D Slicer and of scalismo") {
  const LandmarkFolder folder;
  for (const char* name : {"points.mrk.json", "points.fcsv", "points.json"}) {
    REQUIRE(write_landmarks(two_poles, folder.path / name));
    CHECK(read_landmarks(folder.path / name).value() == two_poles);
  }
}

TEST_CASE("landmarks that Slicer saved in RAS are turned to LPS and those not placed are left out") {
  const LandmarkFolder folder;
  const auto read = read_landmarks(folder.file("ras.mrk.json", R"({"markups": [{"coordinateSystem": "RAS",
      "controlPoints": [{"id": "1", "label": "hilum", "position": [1, 2, 3], "positionStatus": "defined"},
                        {"id": "2", "label": "pole", "position": [0, 0, 0], "positionStatus": "undefined"},
                        {"id": "7", "label": "", "position": [4, 5, 6]}]}]})"));
  REQUIRE(read);
  CHECK(*read == std::vector<Landmark>{{"hilum", Vec3(-1, -2, 3)}, {"7", Vec3(-4, -5, 6)}});
}

TEST_CASE("the older list of fiducials of Slicer is read whatever its columns and space") {
  const LandmarkFolder folder;
  const std::string head = "# Markups fiducial file version = 4.10\r\n";
  const auto read = [&](const std::string& text) { return read_landmarks(folder.file("f.fcsv", text)); };
  const std::string columns = "# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\r\n";
  const std::string points = "F-1,1,2,3,0,0,0,1,1,1,0,hilum,,\r\nF-2,4,5,6,0,0,0,1,1,1,0,\"a \"\"b\"\", c\",,\r\n";
  const std::vector<Landmark> turned{{"hilum", Vec3(-1, -2, 3)}, {"a \"b\", c", Vec3(-4, -5, 6)}};
  CHECK(read(head + "# CoordinateSystem = 0\r\n" + columns + points).value() == turned);
  CHECK(read(head + "# CoordinateSystem = RAS\r\n" + columns + points).value() == turned);
  CHECK(read(head + points).value() == turned);
  CHECK(read(head + "# CoordinateSystem = LPS\n" + columns + points).value().front().position == Vec3(1, 2, 3));
  CHECK(read(head + "# CoordinateSystem = LPS\n# columns = label,x,y,z\nhilum,1,2,3\n").value() ==
        std::vector<Landmark>{{"hilum", Vec3(1, 2, 3)}});
  const auto refusal = [&](const std::string& text) {
    const auto landmarks = read(text);
    return landmarks ? "" : landmarks.error().what;
  };
  CHECK(refusal(head + "# CoordinateSystem = IJK\n" + points).find("IJK") != std::string::npos);
  CHECK(refusal(head + "F-1,1,two,3,0,0,0,1,1,1,0,hilum,,\n").find("three coordinates") != std::string::npos);
  CHECK(refusal(head + points + points).find("two points named") != std::string::npos);
  CHECK(refusal("hello\n") != "");
  CHECK(refusal("").find("no fiducial file") != std::string::npos);
}

TEST_CASE("fiducials with decimal commas are refused and the two further fields of Slicer 5 are not") {
  const LandmarkFolder folder;
  const std::string head =
      "# Markups fiducial file version = 4.11\n# CoordinateSystem = LPS\n"
      "# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\n";
  const auto read = [&](const std::string& line) { return read_landmarks(folder.file("f.fcsv", head + line + '\n')); };
  for (const char* line :
       {"1,1,5,2,5,3,5,0,0,0,1,1,1,0,a,,", "1,1,5,2,5,3,5,0,0,0,1,1,1,0,a", "1,1,5,2,5,3,5",
        "1,1,5,2,3,0,0,0,1,1,1,0,a,,", "1,1,5,2,5,3,0,0,0,1,1,1,0,a", "1,1,5,2,3,0,0,0,1,1,1,0,a,,,2,0"}) {
    CAPTURE(line);
    const auto landmarks = read(line);
    REQUIRE(!landmarks);
    CHECK(landmarks.error().what.find("decimal points") != std::string::npos);
  }
  for (const char* line :
       {"1,1.5,2.5,3.5,0,0,0,1,1,1,0,a,,,2,0", "1,1.5,2.5,3.5,0,0,0,1,1,1,0,a,,vtkMRMLScalarVolumeNode1",
        "1,1.5,2.5,3.5,0.707107,0,0,0.707107,1,1,0,a", "a,1.5,2.5,3.5"}) {
    CAPTURE(line);
    CHECK(read(line).value() == std::vector<Landmark>{{"a", Vec3(1.5, 2.5, 3.5)}});
  }
}

TEST_CASE("a space of markups that is no name is refused") {
  const LandmarkFolder folder;
  for (const char* space : {"0", "1", "null", "[\"RAS\"]", "true"}) {
    CAPTURE(space);
    const std::string why = folder.refusal(R"({"markups": [{"coordinateSystem": )" + std::string(space) +
                                           R"(, "controlPoints": [{"label": "a", "position": [1, 2, 3]}]}]})");
    CHECK(why.find("write \"LPS\" or \"RAS\"") != std::string::npos);
  }
}

TEST_CASE("a landmark file that cannot be understood is refused with a sentence") {
  const LandmarkFolder folder;
  CHECK(folder.refusal("[{\"id\":").find("no valid JSON") != std::string::npos);
  CHECK(folder.refusal("{\"points\": []}").find("neither markups") != std::string::npos);
  CHECK(folder.refusal("3").find("neither markups") != std::string::npos);
  CHECK(folder.refusal(R"([{"coordinates": [1, 2, 3]}])").find("without a name") != std::string::npos);
  CHECK(folder.refusal(R"([{"id": "a", "coordinates": [1, 2]}])").find("three coordinates") != std::string::npos);
  CHECK(folder.refusal(R"([{"id": "a", "coordinates": [1, 2, null]}])").find("three coordinates") != std::string::npos);
  CHECK(folder.refusal(R"([{"id": "a", "coordinates": [1, 2, 1e999]}])") != "");
  CHECK(folder.refusal(R"([1])").find("without a name") != std::string::npos);
  CHECK(folder.refusal(R"([{"id": "a", "coordinates": [1, 2, 3]}, {"id": "a", "coordinates": [1, 2, 4]}])")
            .find("two points named \"a\"") != std::string::npos);
  CHECK(folder.refusal(R"({"markups": [{"coordinateSystem": "IJK", "controlPoints": []}]})").find("IJK") !=
        std::string::npos);
  CHECK(folder.refusal(R"({"markups": [{"coordinateUnits": "m", "controlPoints": []}]})").find("mm") !=
        std::string::npos);
  CHECK(folder.refusal(R"({"markups": [7]})").find("control points") != std::string::npos);
  CHECK(read_landmarks(folder.path / "absent.json").error().what.find("does not exist") != std::string::npos);
  CHECK(!write_landmarks(two_poles, folder.path / "points.txt"));
}

TEST_CASE("a landmark that lies beyond any body is refused by name") {
  const LandmarkFolder folder;
  for (const std::string huge : {"1e308", "-1e10", "1000000001"}) {
    CHECK(folder.refusal(R"([{"id":"tip","coordinates":[0,0,)" + huge + "]}]")
              .find("\"tip\" lies beyond 1,000,000,000 mm") != std::string::npos);
    CHECK(folder
              .refusal(R"({"markups":[{"coordinateSystem":"LPS","controlPoints":[{"label":"tip","position":[)" + huge +
                       ",0,0]}]}]}")
              .find("\"tip\" lies beyond") != std::string::npos);
  }
}
