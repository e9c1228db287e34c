#include "core/case/action_line.h"

#include "tests/case_steps.h"
#include "tests/failing_memory.h"
#include "tests/small_files.h"

namespace homolog {

TEST_CASE("a session without memory for its history undoes and redoes to the last bit") {
  const CaseFolder folder;
  std::mt19937 random(1), same(1);
  EditSession spacious = folder.create();
  const HistoryLimits none{.bytes = 0, .replayed_steps = 16};
  auto narrow = create_case(folder.document(), folder.folder.path / "narrow.homolog", none).value();
  work(spacious, random, 50);
  work(narrow, same, 50);
  CHECK(same_document(spacious.document(), narrow.document()));
  const auto wanted = all_states(spacious);
  CHECK(wanted.size() > 20);
  CHECK(same_states(all_states(narrow), wanted));
  while (spacious.can_redo()) {
    REQUIRE(spacious.apply(Redo{}));
    REQUIRE(narrow.apply(Redo{}));
    REQUIRE(spacious.redo_name() == narrow.redo_name());
  }
  CHECK(same_document(spacious.document(), narrow.document()));
  // What was not saved yet has its lines in memory, and does the same.
  EditSession unsaved(folder.document(), {.bytes = 100'000});
  std::mt19937 again(1);
  work(unsaved, again, 50);
  CHECK(same_states(all_states(unsaved), wanted));
}

TEST_CASE("the history keeps to its memory however much is done") {
  const CaseFolder folder;
  constexpr std::size_t limit = 500'000;
  EditSession session = create_case(folder.document(), folder.case_path, {.bytes = limit}).value();
  std::mt19937 random(2);
  const Points start = *session.document().view()->shape.points;
  for (int k = 0; k < 100; ++k) {  // 15 kB each, and as much again for what is known of it
    REQUIRE(session.apply(random_snap(session.document(), random)));
    REQUIRE(session.history_bytes() <= limit);
  }
  CHECK(session.history_bytes() > limit / 4);
  while (session.can_undo()) {
    REQUIRE(session.apply(Undo{}));
    REQUIRE(session.history_bytes() <= limit);
  }
  CHECK(*session.document().view()->shape.points == start);
}

TEST_CASE("states that come with looks at other frames count too") {
  const CaseFolder folder;
  constexpr std::size_t limit = 900'000;
  constexpr int frames = 12;  // 50 kB each once they are snapped, of which a first look brings a third
  EditSession session = create_case(cine_document(folder, frames), folder.case_path, {.bytes = limit}).value();
  std::mt19937 random(3);
  for (int k = 0; k < 120; ++k) {
    REQUIRE(session.apply(SetFrame{k % frames, false}));
    REQUIRE(session.apply(random_snap(session.document(), random)));
    REQUIRE(session.history_bytes() <= limit);
  }
}

TEST_CASE("steps that were made are counted once and a note joins nothing to the step before it") {
  const CaseFolder folder;
  EditSession session = folder.create();
  const auto paint = [](double x) { return PaintStiffness{Vec3(x, 0, 40), 10, 20, 0.5}; };
  for (int k = 0; k < 5; ++k) REQUIRE(session.apply(paint(k), k > 0));
  CHECK(session.steps_made() == 1);
  REQUIRE(session.apply(SetStiffnessBase{5}));
  REQUIRE(session.apply(Undo{}));
  REQUIRE(session.apply(Note{"a remark"}));
  CHECK_FALSE(session.apply(SetStiffnessBase{-1}));
  CHECK(session.steps_made() == 2);
  REQUIRE(session.apply(Undo{}));
  REQUIRE(session.apply(Redo{}));
  REQUIRE(session.apply(Note{"a remark"}));
  REQUIRE(session.apply(paint(9), true));  // a step of its own: what was before it was no touch of this stroke
  CHECK(session.steps_made() == 3);
  CHECK(session.undo_names(9).size() == 2);
}

TEST_CASE("undo and redo go over what is joined and over what was only looked at") {
  History history(std::make_shared<const Document>(), 1000);
  const auto push = [&](bool joined, bool look) {
    history.reserve(1);
    history.push({.joined = joined, .look = look});
  };
  push(false, false);  // step 0
  push(true, false);
  push(true, false);
  push(false, true);
  push(false, false);  // step 4
  const auto leads = [](const std::optional<History::Way>& way, std::size_t to, std::size_t first, std::size_t last) {
    return way && way->to == to && way->first == first && way->last == last;
  };
  CHECK(history.current() == 5);
  CHECK(leads(history.undo(), 4, 4, 4));
  CHECK(leads(history.undo(4), 0, 0, 2));
  CHECK_FALSE(history.undo(0));
  CHECK(leads(history.redo(0), 3, 0, 2));
  CHECK(leads(history.redo(3), 5, 4, 4));
  CHECK_FALSE(history.redo(5));
  history.go_to(3);
  push(false, false);  // what could be done again is forgotten
  CHECK(history.size() == 4);
  CHECK(history.current() == 4);
  CHECK_FALSE(history.redo());
  CHECK(leads(history.undo(), 3, 3, 3));
}

TEST_CASE("states near the present one are kept and those far away are thinned out evenly") {
  const auto state = [] {
    auto document = std::make_shared<Document>();
    auto structure = std::make_shared<Structure>();
    structure->paint.stiffness = std::make_shared<const VertexScalars>(VertexScalars::Ones(125));  // 1,000 bytes
    document->structures.push_back(std::move(structure));
    return document;
  };
  History history(state(), 100'000);
  for (std::size_t k = 1; k <= 300; ++k) {
    history.reserve(1);
    history.push({.after = nullptr});
    history.keep(k, state());
    CHECK(history.bytes() <= 100'000);
  }
  for (std::size_t k = 268; k <= 300; ++k) CHECK(history.kept(k) != nullptr);
  std::vector<std::size_t> far;
  for (std::size_t k = 1; k < 200; ++k)
    if (history.kept(k) != nullptr) far.push_back(k);
  REQUIRE(far.size() > 5);
  for (std::size_t k = 1; k < far.size(); ++k) CHECK(far[k] - far[k - 1] <= 2 * far[0]);
  CHECK(history.bytes() > 50'000);
  CHECK(history.kept(0) != nullptr);
}

TEST_CASE("the touches of a brush stroke are kept once") {
  const CaseFolder folder;
  EditSession session = folder.create();
  const auto bytes_before = session.history_bytes();
  for (int k = 0; k < 100; ++k) REQUIRE(session.apply(PaintStiffness{Vec3(0, 0.1 * k, 40), 10, 20, 0.5}, k > 0));
  const std::size_t a_state =
      sizeof(double) * static_cast<std::size_t>(session.document().structure()->paint.stiffness->size());
  CHECK(session.history_bytes() - bytes_before == a_state);
  // They are written at once, and brought to the disk together.
  CHECK(session.unsynced());
  REQUIRE(session.sync());
  CHECK_FALSE(session.unsynced());
  CHECK(read_case(folder.case_path)->session.undo_name() == session.undo_name());
  REQUIRE(session.apply(Undo{}));
  CHECK_FALSE(session.can_undo());
}

TEST_CASE("to look at a frame is no step and keeps what can be done again") {
  const CaseFolder folder;
  EditSession session(cine_document(folder, 5));
  REQUIRE(session.apply(pull(pole, 1.1 * pole)));
  const Points pulled = *session.document().view()->shape.points;
  REQUIRE(session.apply(SetFrame{3}));
  CHECK(session.document().frame == 3);
  CHECK(session.undo_name().starts_with("pull"));
  REQUIRE(session.apply(Stroke{.tool = Tool::grab, .at = pole, .to = 1.2 * pole, .sigma_mm = 10}));
  REQUIRE(session.apply(Undo{}));
  // Back at where it was done, and looking elsewhere changes nothing of that.
  CHECK(session.document().frame == 3);
  REQUIRE(session.apply(SetFrame{1}));
  REQUIRE(session.apply(SetFrame{4}));
  CHECK(session.document().frame == 4);
  CHECK(session.redo_name().starts_with("grab"));
  REQUIRE(session.apply(Redo{}));
  CHECK(session.document().frame == 3);
  CHECK(session.document().view()->shape.points->col(2).maxCoeff() > 47);
  REQUIRE(session.apply(Undo{}));
  REQUIRE(session.apply(Undo{}));
  CHECK(session.document().frame == 0);
  CHECK_FALSE(session.can_undo());
  REQUIRE(session.apply(Redo{}));
  CHECK(session.document().frame == 0);
  CHECK(*session.document().view()->shape.points == pulled);
  // What is looked at last is where the next stroke goes, also without memory for it.
  REQUIRE(session.apply(SetFrame{2}));
  REQUIRE(session.apply(pull(pole, 1.1 * pole)));
  CHECK(session.document().structure()->shape(2)->strokes == 1);
  CHECK_FALSE(session.can_redo());
}

TEST_CASE("looks replay from the file as they were and steps of older files stay steps") {
  const CaseFolder folder;
  const auto write = [&](const std::string& text) { std::ofstream(folder.case_path) << text; };
  { const EditSession begun = folder.create(); }
  const std::string header = folder.text();
  const std::string stroke = action_line({pull(pole, 1.1 * pole)}) + '\n';
  write(header + stroke + "{\"frame\":0}\n{\"undo\":true}\n");
  CHECK(read_case(folder.case_path)->session.strokes() == 1);
  write(header + stroke + "{\"frame\":0,\"look\":true}\n{\"undo\":true}\n");
  CHECK(read_case(folder.case_path)->session.strokes() == 0);
  CHECK(action_line({SetFrame{2}}) == R"({"frame":2,"look":true})");
}

TEST_CASE("a look that cannot be written is done and written with the next edit") {
  const CaseFolder folder;
  EditSession session = folder.create();
  const std::string before = folder.text();
  bool looked = false, edited = true;
  {
    const SmallFilesOnly full(before.size());
    looked = session.apply(SetFrame{0}).has_value();
    edited = session.apply(SetStiffnessBase{5}).has_value();
  }
  CHECK(looked);
  CHECK_FALSE(edited);
  CHECK(folder.text() == before);
  REQUIRE(session.apply(SetStiffnessBase{5}));
  CHECK(folder.text() == before + "{\"frame\":0,\"look\":true}\n{\"stiffness_base\":5.0}\n");
}

TEST_CASE("where memory runs out the case is as the disk says") {
  const CaseFolder folder;
  EditSession session = folder.create();
  const std::string long_name(2000, 'n');
  const std::vector<Action> actions{SetStiffnessBase{5},
                                    PlaceLandmark{long_name, pole},
                                    PaintStiffness{pole, 15, 30, 0.5},
                                    Note{long_name},
                                    pull(pole, 1.1 * pole),
                                    random_snap(session.document(), *std::make_unique<std::mt19937>(3)),
                                    SetFrame{0},
                                    Undo{},
                                    Redo{}};
  int ran_out = 0;
  for (const Action& action : actions) {
    for (int allocations = 0;; ++allocations) {
      const auto before = session.shared_document();
      const std::string undo = session.undo_name(), redo = session.redo_name(), text = folder.text();
      Action copy = action;
      try {
        const test::MemoryEndsAfter end(allocations);
        const auto done = session.apply(std::move(copy));
        if (done) break;
      } catch (const std::bad_alloc&) {
      }
      ++ran_out;
      REQUIRE((session.shared_document() == before));
      REQUIRE(folder.text() == text);
      REQUIRE(session.undo_name() == undo);
      REQUIRE(session.redo_name() == redo);
    }
    const auto read = read_case(folder.case_path);
    REQUIRE(read);
    CHECK(same_document(read->session.document(), session.document()));
  }
  CHECK(ran_out > 30);
}

TEST_CASE("what can be undone and done again is named with the next one first") {
  const CaseFolder folder;
  EditSession session = folder.create();
  REQUIRE(session.apply(pull(pole, 1.1 * pole)));
  REQUIRE(session.apply(SetStiffnessBase{5}));
  REQUIRE(session.apply(PaintStiffness{pole, 10, 20, 0.5}));
  const auto begin_with = [](const std::vector<std::string>& names, const std::vector<std::string>& words) {
    return names.size() == words.size() && std::equal(names.begin(), names.end(), words.begin(),
                                                      [](const auto& a, const auto& b) { return a.starts_with(b); });
  };
  CHECK(begin_with(session.undo_names(9), {"stiffness brush", "stiffness", "pull"}));
  CHECK(session.undo_names(2).size() == 2);
  CHECK(session.redo_names(9).empty());
  const auto undone = session.apply(Undo{});
  REQUIRE(undone);
  CHECK(undone->message.starts_with("Undone: stiffness brush"));
  REQUIRE(session.apply(Undo{}));
  CHECK(begin_with(session.redo_names(9), {"stiffness", "stiffness brush"}));
  const auto redone = session.apply(Redo{});
  REQUIRE(redone);
  CHECK(redone->message.starts_with("Redone: stiffness"));
  CHECK(session.redo_name().starts_with("stiffness brush"));
}

}  // namespace homolog
