#include "app/editor/window/editor_app.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <iterator>
#include <thread>

#include "app/editor/update/results/opening.h"
#include "app/editor/update/results/results.h"
#include "app/editor/work/opening/sort_files.h"
#include "core/base/files/paths.h"
#include "core/base/processes/guarded.h"
#include "core/structures/template_set.h"

namespace homolog {

EditorApp::EditorApp(std::function<void()> wake) : shown_(wake), work_(wake) {}

EditorApp::~EditorApp() {
  const auto warn = [](const std::vector<std::string>& sentences) {
    for (const std::string& sentence : sentences) std::fprintf(stderr, "homolog: warning: %s\n", sentence.c_str());
  };
  warn(work_.models.close(state_.models));
  work_.snaps.cancel();
  work_.contour_fits.cancel();
  warn(told(shown_.close()));
}

void EditorApp::start_session(EditSession session) {
  homolog::start_session(editing_, std::move(session));
}

void EditorApp::start(const EditorOptions& options) {
  work_.write_report = options.write_report;
  work_.recovery.look();
  start_session(EditSession(new_document({}, nullptr, nullptr)));
  if (!options.log.empty())
    if (auto writes = log_.write_to(options.log); !writes) add_notice(state_, writes.error().sentence());
  if (!options.replay.empty()) {
    auto commands = read_log(options.replay);
    if (!commands) return add_notice(state_, commands.error().sentence());
    return replay(std::move(*commands));
  }
  if (options.demo) return send(open_phantom(*options.demo, 1));
  if (options.files.empty() && options.template_source.empty()) return send(open_phantom(Organ::kidney, 1));
  if (options.files.size() == 1 && is_study_file(options.files.front())) {
    send(ShowModels{true});
    send(OpenStudy{{absolute_path(options.files.front())}});
    return;
  }
  auto files = options.files;
  if (const auto set = std::ranges::find_if(files, is_template_set); set != files.end()) {
    send(ChooseSet{absolute_path(*set).string()});
    files.erase(set);
  }
  auto request = sort_files(files);
  if (!request) return add_notice(state_, request.error().sentence());
  if (!options.template_source.empty()) request->template_source = options.template_source;
  send(OpenRequested{std::move(*request)});
  work_.recovery_offer = RecoveryOffer::notice;
}

void EditorApp::handle(const InputEvent& event) {
  const auto handled = guarded("", [&]() -> Result<void> {
    handle_event(state_, event, editing_.controls(), out_);
    return {};
  });
  if (!handled) add_notice(state_, handled.error().sentence());
  run_commands();
}

void EditorApp::run_commands() {
  // Commands may send further ones.
  for (auto commands = out_.take(); !commands.empty(); commands = out_.take())
    for (const Command& command : commands) {
      took_all_ = false;
      run(command, editing_);
    }
  if (std::string fault = log_.take_fault(); !fault.empty()) add_notice(state_, std::move(fault));
}

void EditorApp::replay(std::vector<Command> commands) {
  std::move(commands.begin(), commands.end(), std::back_inserter(to_replay_));
}

bool EditorApp::update(double seconds) {
  bool changed = work_.busy();
  // A Cancel belongs to what runs, all else begins when that is done.
  while (!to_replay_.empty() && out_.empty() && (rests() || to_replay_.front().cancels())) {
    out_.send(std::move(to_replay_.front()));
    to_replay_.pop_front();
  }
  settle_click(state_, seconds, editing_.controls(), out_);
  run_commands();
  const auto done = guarded("", [&]() -> Result<void> {
    const bool nothing_ran = nothing_goes_on();
    changed |= take_results(editing_, seconds);
    took_all_ = nothing_ran;
    return {};
  });
  if (!done) {
    add_notice(state_, done.error().sentence());
    changed = true;
  }
  return changed || busy() || drawing_.draws_on();
}

std::optional<double> EditorApp::next_move_seconds(double now) const {
  if (!to_replay_.empty() || (drawing_.draws_on() && !state_.look.playing)) return 0;
  return homolog::next_move_seconds(state_, work_, now);
}

void EditorApp::preview(Action action) {
  const auto before = shown_.session().snapshot();
  shown_.session().preview(std::move(action));
  while (shown_.session().snapshot() == before) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

void EditorApp::settle() {
  run_commands();
  homolog::settle(editing_);
}

}  // namespace homolog
