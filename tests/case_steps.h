#pragma once

#include <random>

#include "core/session/checkpoint.h"
#include "tests/case_folder.h"

namespace homolog {

/// A case with a cine of `frames` frames, without anything to see in them.
inline Document cine_document(const CaseFolder& folder, int frames) {
  Volume cine;
  cine.geometry.dims = {2, 2, 2};
  cine.frames = frames;
  cine.data = std::vector<std::int16_t>(8 * static_cast<std::size_t>(frames));
  Document document = folder.document();
  document.scan.image = std::make_shared<const Volume>(std::move(cine));
  return document;
}

/// A snap of the whole mesh as it would be: every landmark up to half a millimetre away.
inline SetPoints random_snap(const Document& document, std::mt19937& random, double share = 1) {
  std::uniform_real_distribution<double> mm(-0.5, 0.5), chance(0, 1);
  Points points = *document.view()->shape.points;
  for (Eigen::Index i = 0; i < points.rows(); ++i)
    if (chance(random) < share) points.row(i) += Eigen::RowVector3d(mm(random), mm(random), mm(random));
  return points_edit(*document.view(), points, FoundBy::snap);
}

inline Vec3 random_place(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return 40 * Vec3(normal(random), normal(random), normal(random)).normalized();
}

/// Does what a day's work does, `count` times: strokes, snaps, brushes, landmarks, undo and redo.
inline void work(EditSession& session, std::mt19937& random, int count) {
  for (int k = 0; k < count; ++k) {
    const Vec3 at = random_place(random);
    switch (random() % 10) {
      case 0:
      case 1:
      case 2:
        (void)session.apply(pull(at, 1.05 * at));
        break;
      case 3:
      case 4:
        REQUIRE(session.apply(random_snap(session.document(), random, random() % 2 == 0 ? 1 : 0.1)));
        break;
      case 5:
        for (int touch = 0; touch < 4; ++touch)
          REQUIRE(session.apply(PaintStiffness{at + Vec3(touch, 0, 0), 10, 20, 0.5}, touch > 0));
        break;
      case 6:
        REQUIRE(session.apply(Confirm{at, 10, random() % 2 == 0}));
        break;
      case 7:
        REQUIRE(session.apply(Stroke{.tool = Tool::relax, .at = at, .to = at, .sigma_mm = 12, .strength = 0.7}));
        break;
      case 8:
        for (auto back = random() % 4; back > 0 && session.can_undo(); --back) REQUIRE(session.apply(Undo{}));
        break;
      case 9:
        if (session.can_redo()) REQUIRE(session.apply(Redo{}));
        break;
    }
  }
}

/// Every state from the present one back to the start, by undo.
inline std::vector<std::shared_ptr<const Document>> all_states(EditSession& session) {
  std::vector<std::shared_ptr<const Document>> states{session.shared_document()};
  while (session.can_undo()) {
    REQUIRE(session.apply(Undo{}));
    states.push_back(session.shared_document());
  }
  return states;
}

inline bool same_states(const std::vector<std::shared_ptr<const Document>>& a,
                        const std::vector<std::shared_ptr<const Document>>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const auto& x, const auto& y) { return same_document(*x, *y); });
}

}  // namespace homolog
