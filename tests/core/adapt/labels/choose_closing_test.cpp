#include <doctest/doctest.h>

#include <cmath>

#include "core/adapt/labels/choose_closing.h"
#include "core/measure/compare.h"
#include "core/mesh/voxels/isosurface.h"
#include "core/volume/volume_io.h"
#include "tests/real_data.h"

using namespace homolog;

namespace {

Volume kidney_mask(const std::filesystem::path& data, const std::string& name) {
  return read_volume(data / "kidney_masks" / (name + ".nii.gz")).value().volume;
}

}  // namespace

TEST_CASE("a kidney with deep clefts asks for a wider closing and its fits to others become sound by that") {
  const auto data = real_data();
  if (data.empty()) return;
  const Volume deep = kidney_mask(data, "case_00096_left_healthy_thin");
  const Volume other = kidney_mask(data, "case_00014_left_healthy_thin");
  MaskTemplateOptions options;
  options.label = every_label;
  const ClosingChoice choice = choose_template_closing(deep, options, nullptr);
  CHECK(choice.closing_mm > 2 * usual_closing_mm(deep, every_label, 0));
  REQUIRE(choice.tried.size() == 3);
  CHECK(choice.tried[0].doubtful);
  const auto raw_dice = [&](double closing_mm) {
    options.closing_mm = closing_mm;
    const auto made = make_mask_template(deep, options).value();
    const auto own = make_template({made.mesh.points, made.mesh.topology->triangles()}, "own").value();
    const auto boundary = label_boundary(other, every_label, 0, closing_mm, own->points.rows()).value();
    return dice_with_mask(fit_to_boundary(*own, boundary).value().mesh, other, every_label);
  };
  CHECK(raw_dice(choice.closing_mm) > raw_dice(usual_closing_mm(deep, every_label, 0)) + 0.01);
}

TEST_CASE("a kidney without deep clefts is closed by an edge only where that costs next to nothing") {
  const auto data = real_data();
  if (data.empty()) return;
  const Volume plain = kidney_mask(data, "case_00008_left_healthy_thick");
  MaskTemplateOptions options;
  options.label = every_label;
  const ClosingChoice choice = choose_template_closing(plain, options, nullptr);
  REQUIRE(choice.tried.size() == 2);
  CHECK_FALSE(choice.tried[0].doubtful);
  const double cost = choice.tried[0].dice_raw - choice.tried[1].dice_raw;
  const double usual_mm = usual_closing_mm(plain, every_label, 0);
  CHECK(choice.closing_mm == (cost <= 0.001 ? choice.tried[1].closing_mm : usual_mm));
  CHECK(choice.tried[1].closing_mm > usual_mm);
}

TEST_CASE("a doubtful fit is made sound by a wider closing and mirrored ones are left alone") {
  const auto data = real_data();
  if (data.empty()) return;
  const Volume plain = kidney_mask(data, "case_00003_left_healthy_thin");
  const Volume deep = kidney_mask(data, "case_00063_left_healthy_thin");
  MaskTemplateOptions options;
  options.label = every_label;
  const auto made = make_mask_template(plain, options).value();
  const auto own = make_template({made.mesh.points, made.mesh.topology->triangles()}, "own").value();
  OtherClosing first;
  first.closing_mm = usual_closing_mm(deep, every_label, 0);
  first.boundary = label_boundary(deep, every_label, 0, first.closing_mm, own->points.rows()).value();
  first.fit = fit_to_boundary(*own, first.boundary).value();
  first.judgement = judge_fit(*own, first.boundary, {}, first.fit);
  REQUIRE(first.judgement.doubtful);
  const MoreClosing more = try_more_closing(*own, deep, every_label, 0, {}, {}, first);
  REQUIRE(more.better);
  CHECK_FALSE(more.better->judgement.doubtful);
  CHECK(more.better->closing_mm > first.closing_mm);
  first.fit.mirrored = true;
  CHECK(try_more_closing(*own, deep, every_label, 0, {}, {}, first).tried.empty());
}
