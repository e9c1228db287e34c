// Pictures for print, and a mode that plays.
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <regex>

#include "core/base/encoding/base64.h"
#include "core/base/files/file_record.h"
#include "core/base/pictures/picture_io.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_io.h"
#include "tests/command_line.h"

namespace homolog {

namespace {

/// Ellipsoids k0.ply to k5.ply in correspondence, the last three longer, with a table of what they are and a model.
std::string put_shapes(const TemporaryFolder& folder) {
  std::string files;
  std::ofstream table(folder.path / "cases.csv");
  table << "case,kind\n";
  for (int k = 0; k < 6; ++k) {
    Mesh mesh = icosphere(2, 40);
    mesh.points.col(0) *= 1 + 0.05 * std::sin(k);
    mesh.points.col(2) *= k < 3 ? 1 : 1.25;
    const std::string name = "k" + std::to_string(k);
    files += ' ' + name + ".ply";
    table << name << (k < 3 ? ",short\n" : ",long\n");
    REQUIRE(write_mesh(mesh, folder.path / (name + ".ply")));
  }
  return files;
}

std::string read(const TemporaryFolder& folder, const std::string& name) {
  return read_whole_file(folder.path / name).value_or("");
}

struct SvgText {
  double x, y, size;
  std::string anchor, text;
};

std::vector<SvgText> texts_of(const std::string& svg) {
  static const std::regex pattern(
      R"re(<text x="([-0-9.]+)" y="([-0-9.]+)" font-size="([0-9.]+)" fill="#[0-9a-f]{6}" text-anchor="([a-z]+)">([^<]*)</text>)re");
  std::vector<SvgText> texts;
  for (auto it = std::sregex_iterator(svg.begin(), svg.end(), pattern); it != std::sregex_iterator(); ++it)
    texts.push_back({std::stod((*it)[1]), std::stod((*it)[2]), std::stod((*it)[3]), (*it)[4], (*it)[5]});
  return texts;
}

bool has_text(const std::vector<SvgText>& texts, const std::string& wanted) {
  return std::any_of(texts.begin(), texts.end(), [&](const SvgText& one) { return one.text == wanted; });
}

/// Letters are at least 0.45 of their size wide on average.
double least_width_mm(const SvgText& text) {
  return 0.45 * text.size * static_cast<double>(std::count_if(text.text.begin(), text.text.end(), [](char c) {
           return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
         }));
}

/// The pixels that an SVG holds.
Picture shapes_of(const TemporaryFolder& folder, const std::string& svg) {
  const std::string before = "data:image/png;base64,";
  const std::size_t from = svg.find(before) + before.size(), to = svg.find('"', from);
  REQUIRE(from < svg.size());
  const auto bytes = from_base64(std::string_view(svg).substr(from, to - from));
  std::ofstream(folder.path / "shapes.png", std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  return read_picture(folder.path / "shapes.png").value();
}

/// How many pixels under the letters are no ground: letters are at least 0.45 of their size wide on average.
std::size_t covered(const Picture& picture, double px_per_mm, const SvgText& text) {
  const double width = 0.45 * text.size * static_cast<double>(text.text.size());
  const double left = text.anchor == "start" ? text.x : text.anchor == "middle" ? text.x - width / 2 : text.x - width;
  std::size_t count = 0;
  for (int y = static_cast<int>((text.y - 0.8 * text.size) * px_per_mm); y < (text.y + 0.25 * text.size) * px_per_mm;
       ++y)
    for (int x = static_cast<int>(left * px_per_mm); x < (left + width) * px_per_mm; ++x) {
      if (x < 0 || y < 0 || x >= picture.width || y >= picture.height) return 1;
      const auto* pixel =
          picture.rgba.data() +
          4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) + static_cast<std::size_t>(x));
      count += std::any_of(pixel, pixel + 3, [](std::uint8_t part) { return part != 255; });
    }
  return count;
}

}  // namespace

TEST_CASE("pictures for print are SVG with texts that lie over no shape at 300 dpi") {
  const TemporaryFolder folder;
  const std::string files = put_shapes(folder);
  REQUIRE(run(folder, "model" + files + " -o m.h5.json").status == 0);
  if (cannot_draw(run(folder, "picture modes m.h5.json -o x.png"))) return;
  CHECK(run(folder, "picture modes m.h5.json -o x.svg --size 640x480").status == 2);
  REQUIRE(run(folder, "score k5.ply --model m.h5.json -o scores").status == 0);
  const std::vector<std::pair<std::string, std::string>> pictures{
      {"modes m.h5.json",
       "Mode 1, \xe2\x88\x92"
       "3\xe2\x88\x9a\xce\xbb"},
      {"correspondence" + files, "k4"},
      {"map scores/k5.vtp --property z", "z (standard deviations)"},
      {"groups" + files + " --covariates cases.csv --by kind", "long (n = 3)"},
      {"groups k0.ply k1.ply k2.ply --against k3.ply k4.ply k5.ply", "second (n = 3)"},
      {"score k5.ply --model m.h5.json", "Mean of the model"}};
  for (const auto& [picture, text] : pictures)
    for (const int width_mm : {85, 170}) {
      CAPTURE(picture);
      CAPTURE(width_mm);
      const std::string line = "picture " + picture + " --width-mm " + std::to_string(width_mm) + " -o p.svg --json";
      const Ran made = run(folder, line);
      REQUIRE_MESSAGE(made.status == 0, made.errors);
      CHECK(made.json()["width_mm"] == width_mm);
      const std::string svg = read(folder, "p.svg");
      CHECK(svg.find("width=\"" + std::to_string(width_mm) + "mm\"") != std::string::npos);
      const auto texts = texts_of(svg);
      CHECK(has_text(texts, text));
      const Picture shapes = shapes_of(folder, svg);
      CHECK(shapes.width == static_cast<int>(std::lround(width_mm / 25.4 * 300)));
      CHECK(made.json()["size"] == Json::array({shapes.width, shapes.height}));
      for (const SvgText& one : texts)
        CHECK_MESSAGE(covered(shapes, shapes.width / double(width_mm), one) == 0, one.text);
      CHECK(std::count_if(shapes.rgba.begin(), shapes.rgba.end(), [](auto part) { return part < 250; }) > 10000);
      CHECK(run(folder, line).status == 0);
      CHECK(read(folder, "p.svg") == svg);
    }
}

TEST_CASE("a study is printed as its shapes or as its first modes") {
  const TemporaryFolder folder;
  put_shapes(folder);
  Json cases = Json::array();
  for (int k = 0; k < 6; ++k)
    cases.push_back({{"name", "case " + std::to_string(k)}, {"file", "k" + std::to_string(k) + ".ply"}});
  REQUIRE(write_whole_file(folder.path / "s.study.json", Json{{"homolog_study", 1}, {"cases", cases}}.dump()));
  const Ran ran = run(folder, "picture study s.study.json -o s.svg --json");
  if (cannot_draw(ran)) return;
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  CHECK(has_text(texts_of(read(folder, "s.svg")), "k5"));
  REQUIRE(run(folder, "picture study s.study.json --only modes --width-mm 85 -o modes.svg").status == 0);
  const auto texts = texts_of(read(folder, "modes.svg"));
  CHECK_FALSE(has_text(texts, "k5"));
  CHECK(texts.size() > 6);
  REQUIRE(run(folder, "picture study s.study.json --only gallery --view superior -o s.pdf").status == 0);
  CHECK(read(folder, "s.pdf").starts_with("%PDF-"));
  CHECK(run(folder, "picture study s.study.json --view superior -o s.png").status != 0);
}

TEST_CASE("groups say which is the longer one") {
  const TemporaryFolder folder;
  const std::string files = put_shapes(folder);
  if (cannot_draw(run(folder, "picture correspondence k0.ply -o x.png"))) return;
  const Ran made =
      run(folder, "picture groups" + files + " --no-align --covariates cases.csv --by kind -o g.svg --json");
  REQUIRE_MESSAGE(made.status == 0, made.errors);
  CHECK(made.json()["groups"][0]["name"] == "long");
  CHECK(made.json()["groups"][1]["shapes"] == 3);
  // The short ones lie up to 10 mm within the long ones.
  const auto texts = texts_of(read(folder, "g.svg"));
  CHECK(has_text(texts, "10"));
  CHECK(has_text(texts,
                 "\xe2\x88\x92"
                 "10"));
  CHECK(has_text(texts, "short \xe2\x88\x92 long, anterior"));
}

TEST_CASE("a page as PDF is whole and has its font and its size") {
  const TemporaryFolder folder;
  const std::string files = put_shapes(folder);
  REQUIRE(run(folder, "model" + files + " -o m.h5.json").status == 0);
  REQUIRE(run(folder, "picture plot m.h5.json --width-mm 85 -o plot.pdf").status == 0);
  const std::string pdf = read(folder, "plot.pdf");
  CHECK(pdf.starts_with("%PDF-1.5\n"));
  CHECK(pdf.ends_with("%%EOF\n"));
  CHECK(pdf.find("/MediaBox[0 0 240.945 311.811 ]") != std::string::npos);
  CHECK(pdf.find("/ToUnicode") != std::string::npos);
  CHECK(pdf.find("Date") == std::string::npos);
  // Every object lies where the table says.
  const std::size_t table = std::stoul(pdf.substr(pdf.rfind("startxref") + 10));
  REQUIRE(pdf.compare(table, 5, "xref\n") == 0);
  const int count = std::stoi(pdf.substr(table + 7));
  for (int object = 1; object < count; ++object) {
    const std::size_t row = pdf.find('\n', table + 5) + 1 + 20 * static_cast<std::size_t>(object);
    const std::string begin = std::to_string(object) + " 0 obj\n";
    CHECK(pdf.compare(std::stoul(pdf.substr(row, 10)), begin.size(), begin) == 0);
  }
  REQUIRE(run(folder, "picture plot m.h5.json --width-mm 85 -o again.pdf").status == 0);
  CHECK(read(folder, "again.pdf") == pdf);
  if (std::system("command -v pdftotext >/dev/null") != 0) return;
  const std::string out = (folder.path / "text").string();
  REQUIRE(std::system(("pdftotext '" + (folder.path / "plot.pdf").string() + "' '" + out + "'").c_str()) == 0);
  CHECK(read(folder, "text").find("Mode 1 (standard deviations)") != std::string::npos);
}

TEST_CASE("columns of a table are plotted, as numbers and as groups") {
  const TemporaryFolder folder;
  std::string table = "case;age;volume_ml;group\n";
  for (int k = 0; k < 12; ++k)
    table += "c" + std::to_string(k) + ";" + std::to_string(40 + k) + ",5;" + std::to_string(100 + 3 * k) +
             (k % 3 == 0 ? ";ill\n" : ";well\n");
  REQUIRE(write_whole_file(folder.path / "t.csv", table + "c12;;180;ill\n"));
  const auto count = [](const std::string& text, const std::string& part) {
    std::size_t found = 0;
    for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
    return found;
  };
  const Ran numbers = run(folder, "picture plot t.csv --x age --y volume_ml --by group -o n.svg");
  REQUIRE_MESSAGE(numbers.status == 0, numbers.errors);
  const std::string drawn = read(folder, "n.svg");
  for (const char* word : {">age<", ">volume (ml)<", ">ill<", ">well<"})
    CHECK_MESSAGE(drawn.find(word) != drawn.npos, word);
  const Ran groups = run(folder, "picture plot t.csv --x group --y volume_ml --width-mm 85 -o g.svg");
  REQUIRE_MESSAGE(groups.status == 0, groups.errors);
  // The case without an age counts here: a dot more than there.
  const std::string by_group = read(folder, "g.svg");
  CHECK(by_group.find(">ill<") != by_group.npos);
  CHECK(count(by_group, "<path") != count(drawn, "<path"));
  check_refused(run(folder, "picture plot t.csv --x age --y weight -o a.svg"),
                "has no column weight; it has case, age");
  check_refused(run(folder, "picture plot t.csv --x age --y group -o a.svg"), "where group should be a number");
  CHECK(run(folder, "picture plot t.csv --x age -o a.svg").status == 2);
  CHECK_FALSE(fs::exists(folder.path / "a.svg"));
}

TEST_CASE("long names of groups stay on the page and beside each other") {
  const TemporaryFolder folder;
  const std::vector<std::string> names{"Patients with chronic kidney disease", "Healthy volunteers, screened",
                                       "Diabetes mellitus type 2", "Siblings of the patients"};
  std::string table = "case,age,val,grp\n";
  for (int k = 0; k < 24; ++k)
    table += "c" + std::to_string(k) + "," + std::to_string(40 + k) + "," + std::to_string(k * 3 % 7) + ",\"" +
             names[static_cast<std::size_t>(k % 4)] + "\"\n";
  REQUIRE(write_whole_file(folder.path / "t.csv", table + "c24,,4,Siblings of the patients\nc25,50,,NA\n"));
  for (const std::string shown : {"--x age --y val --by grp", "--x grp --y val", "--x grp --y val --by grp"})
    for (const int width_mm : {85, 170}) {
      CAPTURE(shown);
      CAPTURE(width_mm);
      const Ran ran = run(folder, "picture plot t.csv " + shown + " -o p.svg --width-mm " + std::to_string(width_mm));
      REQUIRE_MESSAGE(ran.status == 0, ran.errors);
      const bool by_age = shown.find("age") != std::string::npos;
      CHECK(ran.errors.find(by_age ? "2 rows lack a value and are left out" : "1 row lacks a value and is left out") !=
            std::string::npos);
      std::vector<std::array<double, 3>> places;  // from, to, the baseline
      for (const SvgText& one : texts_of(read(folder, "p.svg"))) {
        const double width = least_width_mm(one);
        const double from = one.anchor == "start" ? one.x : one.anchor == "middle" ? one.x - width / 2 : one.x - width;
        CHECK_MESSAGE((from >= 0 && from + width <= width_mm), one.text);
        for (const auto& [other_from, other_to, y] : places)
          CHECK_MESSAGE((std::abs(y - one.y) > 1 || from > other_to || from + width < other_from), one.text);
        places.push_back({from, from + width, one.y});
      }
    }
  // In full where there is room: lines of a name, and rows of colours.
  CHECK(has_text(texts_of(read(folder, "p.svg")), "Diabetes mellitus type 2"));
  REQUIRE(run(folder, "picture plot t.csv --x age --y val --by grp -o p.svg --width-mm 85").status == 0);
  for (const std::string& name : names) CHECK_MESSAGE(has_text(texts_of(read(folder, "p.svg")), name), name);
}

TEST_CASE("a long name of a group leaves the sign of a difference and the unit") {
  const TemporaryFolder folder;
  const std::string files = put_shapes(folder);
  if (cannot_draw(run(folder, "picture correspondence" + files + " -o x.png"))) return;
  std::string table = "case,kind\n";
  for (int k = 0; k < 6; ++k)
    table += "k" + std::to_string(k) + (k < 3 ? ",Diabetes mellitus type 2\n" : ",\"Healthy volunteers, screened\"\n");
  REQUIRE(write_whole_file(folder.path / "long.csv", table));
  const Ran ran = run(folder, "picture groups" + files + " --covariates long.csv --by kind --width-mm 85 -o p.svg");
  REQUIRE_MESSAGE(ran.status == 0, ran.errors);
  int differences = 0;
  bool has_unit = false;
  for (const SvgText& one : texts_of(read(folder, "p.svg"))) {
    differences += one.text.find(" \xe2\x88\x92 ") != std::string::npos ? 1 : 0;
    if (!one.text.starts_with("Outward")) continue;
    has_unit = one.text.ends_with(" (mm)");
    CHECK(one.x + least_width_mm(one) <= 85);
  }
  CHECK(differences == 2);
  CHECK(has_unit);
}

TEST_CASE("measures are plotted with their errors and a broken table is refused by its line") {
  const TemporaryFolder folder;
  const std::string files = put_shapes(folder);
  REQUIRE(run(folder, "evaluate" + files + " --samples 5 --csv e.csv").status == 0);
  REQUIRE(run(folder, "picture plot e.csv -o e.svg").status == 0);
  CHECK(has_text(texts_of(read(folder, "e.svg")), "Specificity error (mm)"));
  std::ofstream(folder.path / "bad.csv") << "modes,compactness,compactness_se\n1,much,0\n";
  const Ran bad = run(folder, "picture plot bad.csv -o b.svg");
  check_refused(bad, "bad.csv");
  CHECK(bad.errors.find("line 2") != std::string::npos);
}

TEST_CASE("a mode plays as GIF and as numbered pictures") {
  const TemporaryFolder folder;
  REQUIRE(run(folder, "model" + put_shapes(folder) + " -o m.h5.json").status == 0);
  const std::string line = "picture modes m.h5.json --mode 1 --frames 8 --size 160x120 -o ";
  const Ran made = run(folder, line + "m.gif --json");
  if (cannot_draw(made)) return;
  REQUIRE_MESSAGE(made.status == 0, made.errors);
  CHECK(made.json()["frames"] == 8);
  const std::string gif = read(folder, "m.gif");
  CHECK(gif.starts_with("GIF89a\xa0"));
  CHECK(gif.find("NETSCAPE2.0") != std::string::npos);
  std::size_t frames = 0;
  for (std::size_t at = gif.find("\x21\xf9\x04"); at != std::string::npos; at = gif.find("\x21\xf9\x04", at + 1))
    ++frames;
  CHECK(frames == 8);
  REQUIRE(run(folder, line + "again.gif").status == 0);
  CHECK(read(folder, "again.gif") == gif);
  REQUIRE(run(folder, line + "f.png").status == 0);
  for (const char* name : {"f-0001.png", "f-0008.png"}) CHECK(fs::exists(folder.path / name));
  CHECK_FALSE(fs::exists(folder.path / "f-0009.png"));
  CHECK_FALSE(fs::exists(folder.path / "f.png"));
  const auto picture = [&](const char* name) { return without_record(name, read(folder, name)); };
  CHECK(picture("f-0001.png") == picture("f-0005.png"));            // the mean
  CHECK(read(folder, "f-0003.png") != read(folder, "f-0007.png"));  // +3 and -3
}

TEST_CASE("what cannot be shown for print is refused with a sentence") {
  const TemporaryFolder folder;
  const std::string files = put_shapes(folder);
  REQUIRE(run(folder, "model" + files + " -o m.h5.json").status == 0);
  const auto refused = [&](const std::string& arguments, const std::string& subject, const std::string& says) {
    const Ran ran = run(folder, "picture " + arguments);
    check_refused(ran, subject);
    CHECK_MESSAGE(ran.errors.find(says) != std::string::npos, ran.errors);
  };
  refused("map k0.ply --property z -o a.svg", "k0.ply", "has no property z");
  refused("map k0.ply --property z --values cases.csv -o a.svg", "cases.csv",
          "has no column vertex; it has case, kind");
  std::ofstream(folder.path / "v.csv") << "vertex,v\n0,1\n1,2\n2,1\n";
  refused("map k0.ply --property v --values v.csv -o a.svg", "v.csv", "is of a mesh of 3 vertices, and k0.ply has ");
  std::ofstream(folder.path / "scan.nii.gz") << "x";
  refused("score scan.nii.gz --model m.h5.json -o a.svg", "scan.nii.gz", "is an image or a label map");
  refused("score nosuch --model m.h5.json -o a.svg", "nosuch", "does not exist");
  refused("groups" + files + " --covariates cases.csv --by age -o a.svg", "age", "is no column");
  refused("plot k0.ply -o a.svg", "k0.ply", "");
  refused("modes m.h5.json --mode 99 -o a.gif", "--mode 99", "is more than");
  if (!cannot_draw(run(folder, "picture modes m.h5.json -o x.png")))
    refused("modes m.h5.json --width-mm 85 -o a.xyz", "a.xyz", "is no kind of picture");
  CHECK(run(folder, "picture modes m.h5.json -o a.gif").status == 2);
  CHECK(run(folder, "picture modes m.h5.json --mode 1 -o a.svg").status == 2);
  CHECK(run(folder, "picture modes m.h5.json --width-mm 85 --size 300x300 -o a.svg").status == 2);
  CHECK(run(folder, "picture groups" + files + " -o a.svg").status == 2);
  CHECK(run(folder, "picture map k0.ply --property z --range 3,1 -o a.svg").status == 2);
  check_refused(run_on_full_disk(folder, "picture plot m.h5.json -o full.pdf", 20000), "full.pdf");
  CHECK_FALSE(fs::exists(folder.path / "full.pdf"));
  CHECK_FALSE(fs::exists(folder.path / "a.svg"));
}

}  // namespace homolog
