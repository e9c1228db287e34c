#include "core/model/files/statismo.h"

#include <doctest/doctest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/base/files/files.h"
#include "core/model/files/hdf_tree.h"
#include "tests/environment_variable.h"
#include "tests/refusal.h"
#include "tests/shapes.h"
#include "tests/small_files.h"
#include "tests/temporary_folder.h"

namespace fs = std::filesystem;
using namespace homolog;
using Json = nlohmann::json;

namespace {

ShapeModel some_model(bool with_faces = true) {
  const Mesh ball = icosphere(1, 20);
  ShapeMatrix shapes(ball.points.size(), 5);
  std::srand(2);
  shapes.setRandom();
  shapes.colwise() += Eigen::Map<const Eigen::VectorXd>(ball.points.data(), ball.points.size());
  return make_model(principal_components(shapes), 0.9, with_faces ? ball.topology : nullptr,
                    {"a", "b", "Nière", "d", "e"});
}

void check_same(const ShapeModel& a, const ShapeModel& b) {
  CHECK(static_cast<bool>(a.topology) == static_cast<bool>(b.topology));
  if (a.topology && b.topology) CHECK(a.topology->hash() == b.topology->hash());
  REQUIRE(a.modes() == b.modes());
  CHECK((a.mean - b.mean).cwiseAbs().maxCoeff() < 1e-5);
  CHECK((a.basis - b.basis).cwiseAbs().maxCoeff() < 1e-7);
  CHECK((a.variances - b.variances).cwiseAbs().maxCoeff() < 1e-6);
  CHECK((a.scores - b.scores).cwiseAbs().maxCoeff() < 1e-5);
  CHECK(a.names == b.names);
}

/// The dataset at a path of an HDF5-JSON file, followed link by link from the root.
Json dataset_at(const Json& file, const std::vector<std::string>& path) {
  std::string id = file["root"];
  for (std::size_t k = 0; k < path.size(); ++k) {
    std::string next, collection;
    for (const Json& link : file["groups"][id]["links"])
      if (link["title"] == path[k]) next = link["id"], collection = link["collection"];
    REQUIRE_MESSAGE(!next.empty(), path[k]);
    CHECK(collection == (k + 1 < path.size() ? "groups" : "datasets"));
    id = next;
  }
  return file["datasets"][id];
}

void change(const fs::path& path, const std::string& from, const std::string& to) {
  std::string text = read_whole_file(path).value();
  const std::size_t at = text.find(from);
  REQUIRE(at != std::string::npos);
  std::ofstream(path) << text.replace(at, from.size(), to);
}

void check_refused(const fs::path& path, const std::string& what) {
  const auto read = read_model(path);
  REQUIRE(!read);
  INFO(read.error().sentence());
  CHECK(read.error().sentence().find(path.filename().string()) != std::string::npos);
  CHECK(read.error().what.find(what) != std::string::npos);
}

}  // namespace

TEST_CASE("a model reads back from both formats as it was written") {
  const TemporaryFolder folder;
  for (const std::string name : {"model.h5.json", "model.h5", "MODEL.H5"}) {
    for (const bool faces : {true, false}) {
      const ShapeModel model = some_model(faces);
      REQUIRE(write_model(model, folder.path / name));
      const auto read = read_model(folder.path / name);
      REQUIRE_MESSAGE(read, read.error().sentence());
      check_same(model, *read);
    }
  }
  CHECK(!write_model(some_model(), folder.path / "model.json"));
}

TEST_CASE("a model's file says which part of a label its shapes are of and one that does not says none") {
  const TemporaryFolder folder;
  for (const std::string name : {"model.h5.json", "model.h5"})
    for (const std::optional<FacedNames>& faced :
         {std::optional<FacedNames>(), std::optional(FacedNames{"left atrium,aorta", false}),
          std::optional(FacedNames{"Knorpel über Knochen", true})}) {
      ShapeModel model = some_model();
      model.faced = faced;
      REQUIRE(write_model(model, folder.path / name));
      const auto read = read_model(folder.path / name);
      REQUIRE_MESSAGE(read, read.error().sentence());
      check_same(model, *read);
      CHECK(read->faced == faced);
    }
}

TEST_CASE("both formats hold the same tree") {
  const TemporaryFolder folder;
  REQUIRE(write_model(some_model(), folder.path / "m.h5"));
  const HdfTree tree = read_hdf5(folder.path / "m.h5", model_parts()).value();
  CHECK(tree.datasets.size() == 13);  // all that a model is made of: eight, and a name for each of five shapes
  REQUIRE(write_hdf5_json(tree, folder.path / "m.h5.json"));
  const HdfTree again = read_hdf5_json(folder.path / "m.h5.json", model_parts()).value();
  CHECK(again.groups == tree.groups);
  REQUIRE(again.datasets.size() == tree.datasets.size());
  for (const auto& [path, dataset] : tree.datasets) {
    CHECK_MESSAGE(again.datasets.at(path).dims == dataset.dims, path);
    CHECK_MESSAGE(again.datasets.at(path).values == dataset.values, path);
  }
}

TEST_CASE("the JSON file has the layout that statismo and scalismo 0.9 publish") {
  const TemporaryFolder folder;
  const EnvironmentVariable clock("SOURCE_DATE_EPOCH", "86400");
  const ShapeModel model = some_model();
  REQUIRE(write_model(model, folder.path / "m.h5.json"));
  const Json file = Json::parse(read_whole_file(folder.path / "m.h5.json").value());
  CHECK(file["apiVersion"].is_string());
  CHECK(dataset_at(file, {"version", "majorVersion"})["value"] == 0);
  CHECK(dataset_at(file, {"version", "minorVersion"})["value"] == 9);
  CHECK(dataset_at(file, {"version", "minorVersion"})["shape"] == Json{{"class", "H5S_SCALAR"}});

  const Json points = dataset_at(file, {"representer", "points"});
  CHECK(points["shape"] == Json{{"class", "H5S_SIMPLE"}, {"dims", {3, 42}}});
  CHECK(points["type"] == Json{{"class", "H5T_FLOAT"}, {"base", "H5T_IEEE_F32LE"}});
  CHECK(points["value"][1][5].get<double>() == doctest::Approx(model.mean[3 * 5 + 1]));
  const Json cells = dataset_at(file, {"representer", "cells"});
  CHECK(cells["shape"]["dims"] == Json::array({3, 80}));
  CHECK(cells["type"] == Json{{"class", "H5T_INTEGER"}, {"base", "H5T_STD_I32LE"}});
  CHECK(cells["value"][2][7] == model.topology->triangles()(7, 2));

  CHECK(dataset_at(file, {"model", "mean"})["shape"]["dims"] == Json::array({126}));
  CHECK(dataset_at(file, {"model", "mean"})["value"][4].get<double>() == doctest::Approx(model.mean[4]));
  const Json basis = dataset_at(file, {"model", "pcaBasis"});
  CHECK(basis["shape"]["dims"] == Json::array({126, model.modes()}));
  CHECK(basis["value"][9][1].get<double>() == doctest::Approx(model.basis(9, 1)));
  CHECK(dataset_at(file, {"model", "pcaVariance"})["shape"]["dims"] == Json::array({model.modes()}));
  CHECK(dataset_at(file, {"model", "noiseVariance"})["value"][0] == 0);
  CHECK(dataset_at(file, {"modelinfo", "build-time"})["type"]["class"] == "H5T_STRING");
  CHECK(dataset_at(file, {"modelinfo", "build-time"})["value"] == "1970-01-02T00:00:00Z");
  CHECK(dataset_at(file, {"modelinfo", "scores"})["shape"]["dims"] == Json::array({model.modes(), 5}));

  std::map<std::string, std::string> attributes;
  for (const auto& [id, group] : file["groups"].items())
    if (group["alias"][0] == "/representer")
      for (const Json& attribute : group["attributes"]) attributes[attribute["name"]] = attribute["value"];
  CHECK(attributes["datasetType"] == "POLYGON_MESH");
  CHECK(attributes.contains("name"));
  CHECK(attributes.contains("version"));
}

TEST_CASE("a model of version 0.8 is read with its basis made orthonormal") {
  const TemporaryFolder folder;
  const ShapeModel model = some_model();
  ShapeModel old = model;
  old.basis *= model.variances.cwiseSqrt().asDiagonal();
  REQUIRE(write_model(old, folder.path / "old.h5"));
  HdfTree tree = read_hdf5(folder.path / "old.h5", model_parts()).value();
  tree.datasets["/version/minorVersion"].values = std::vector<std::int32_t>{8};
  REQUIRE(write_hdf5(tree, folder.path / "old.h5"));
  check_same(model, read_model(folder.path / "old.h5").value());
  tree.datasets["/version/minorVersion"].values = std::vector<std::int32_t>{7};
  REQUIRE(write_hdf5(tree, folder.path / "old.h5"));
  check_refused(folder.path / "old.h5", "version 0.7");
}

TEST_CASE("a file that is no model or a damaged one is refused with the fault named") {
  const TemporaryFolder folder;
  const fs::path json = folder.path / "m.h5.json", hdf5 = folder.path / "m.h5";
  check_refused(json, "does not exist");
  check_refused(hdf5, "does not exist");
  for (const std::string text : {"", "{}", "[1,2]", "not JSON", R"({"root":"x","groups":{}})",
                                 R"({"root":"x","groups":{"x":{"links":[{"class":"H5L_TYPE_HARD","title":"x",
                                 "collection":"groups","id":"x"}]}}})"}) {
    std::ofstream(json) << text;
    CHECK(!read_model(json));
    std::ofstream(hdf5) << text;
    check_refused(hdf5, "HDF5");
  }
  const auto refuse_changed = [&](const std::string& from, const std::string& to, const std::string& what) {
    REQUIRE(write_model(some_model(), json));
    change(json, from, to);
    check_refused(json, what);
  };
  refuse_changed("\"dims\":[126]", "\"dims\":[127]", "fill its shape");
  refuse_changed("POLYGON_MESH", "IMAGE", "IMAGE");
  refuse_changed("pcaBasis", "pcaBasic", "/model/pcaBasis");

  REQUIRE(write_model(some_model(), hdf5));
  const std::string whole = read_whole_file(hdf5).value();
  for (const std::size_t size : {whole.size() / 4, whole.size() / 2, whole.size() - 100}) {
    std::ofstream(hdf5) << whole.substr(0, size);
    CHECK(!read_model(hdf5));
  }
  ShapeModel bent = some_model();
  bent.mean.conservativeResize(123);
  REQUIRE(write_model(bent, hdf5));
  check_refused(hdf5, "does not fit");
}

TEST_CASE("groups that link to one another without end cost nothing") {
  const TemporaryFolder folder;
  // Thirty groups, each of which names the next one twice: 2^30 paths [hdf5-json.readthedocs.io].
  Json file{{"root", "g0"}, {"groups", Json::object()}, {"datasets", Json::object()}};
  for (int k = 0; k < 30; ++k) {
    const auto link = [&](const char* title) {
      return Json{
          {"class", "H5L_TYPE_HARD"}, {"collection", "groups"}, {"title", title}, {"id", "g" + std::to_string(k + 1)}};
    };
    file["groups"]["g" + std::to_string(k)] = {{"links", {link("x"), link("y")}}};
  }
  file["groups"]["g30"] = Json::object();
  const fs::path path = folder.path / "linked.h5.json";
  std::ofstream(path) << file;
  check_refused(path, "/model/mean");
}

TEST_CASE("one dataset under many names does not fill the memory") {
  const TemporaryFolder folder;
  const std::string name(1 << 20, 'n');
  Json names = Json::array();
  for (int k = 0; k < 1000; ++k)
    names.push_back(
        {{"class", "H5L_TYPE_HARD"}, {"collection", "datasets"}, {"id", "n"}, {"title", "URI_" + std::to_string(k)}});
  const auto group = [](const char* title, const char* id) {
    return Json{
        {"links", Json::array({{{"class", "H5L_TYPE_HARD"}, {"collection", "groups"}, {"title", title}, {"id", id}}})}};
  };
  const Json file{{"root", "r"},
                  {"groups",
                   {{"r", group("modelinfo", "i")},
                    {"i", group("modelBuilder-0", "b")},
                    {"b", group("dataInfo", "d")},
                    {"d", {{"links", names}}}}},
                  {"datasets", {{"n", {{"type", {{"class", "H5T_STRING"}}}, {"value", name}}}}}};
  const fs::path path = folder.path / "names.h5.json";
  std::ofstream(path) << file;
  check_refused(path, "too many paths");
}

TEST_CASE("a number of HDF5-JSON that does not fit its type is refused") {
  const TemporaryFolder folder;
  const fs::path path = folder.path / "m.h5.json";
  for (const std::string number : {"1e300", "99999999999", "\"x\""}) {
    REQUIRE(write_model(some_model(), path));
    change(path, "\"value\":0}", "\"value\":" + number + "}");  // of the version
    check_refused(path, "fill its shape");
  }
}

TEST_CASE("a model whose mean or modes lie beyond sense is refused") {
  const TemporaryFolder folder;
  const fs::path path = folder.path / "m.h5.json";
  ShapeModel far = some_model();
  far.mean[4] = 1e11;
  REQUIRE(write_model(far, path));
  check_refused(path, "/model/mean lies beyond 1,000,000,000 mm");
  far = some_model();
  far.basis(2, 0) = 1e11;
  REQUIRE(write_model(far, path));
  check_refused(path, "mode 1 (/model/pcaBasis) moves a point to where it lies beyond 1,000,000,000 mm");
}

TEST_CASE("an HDF5 file that breaks the library is refused and the program goes on") {
  const TemporaryFolder folder;
  const fs::path path = folder.path / "m.h5";
  REQUIRE(write_model(some_model(), path));
  const std::string whole = read_whole_file(path).value();
  // A heap of texts whose entries have no size: the library goes round for ever.
  std::string endless = whole;
  const std::size_t heap = endless.find("GCOL");
  REQUIRE(heap != std::string::npos);
  std::fill_n(endless.begin() + static_cast<std::ptrdiff_t>(heap) + 16, 1000, '\0');
  std::ofstream(path, std::ios::binary) << endless;
  check_refused(path, "damaged HDF5 file");
  std::uint32_t noise = 7;
  for (int round = 0; round < 6; ++round) {
    std::string bytes = whole;
    for (int k = 0; k < 20; ++k) {
      noise = noise * 1664525 + 1013904223;
      bytes[noise % bytes.size()] = static_cast<char>(noise >> 16);
    }
    std::ofstream(path, std::ios::binary) << bytes;
    const auto read = read_model(path);
    if (!read) CHECK(read.error().sentence().size() < 1000);
  }
  std::ofstream(path, std::ios::binary) << whole;
  CHECK(read_model(path));
}

TEST_CASE("a model on a full disk is refused and the old one stays") {
  const TemporaryFolder folder;
  for (const char* name : {"m.h5", "m.h5.json"}) {
    const fs::path path = folder.path / name;
    write_bytes(path, "old");
    Result<void> written;
    {
      const SmallFilesOnly full(4096);
      written = write_model(some_model(), path);
    }
    CHECK(says(written, "cannot be written"));
    CHECK(read_whole_file(path).value() == "old");
  }
}
