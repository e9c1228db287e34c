#include <cassert>

#include "app/editor/update/commands.h"

namespace homolog {

namespace {

/// Appends the command to `commands` where it is a `One`.
template <class One>
bool append_as(std::any& command, std::vector<Command>& commands) {
  One* const one = std::any_cast<One>(&command);
  if (one != nullptr) commands.push_back(Command(std::in_place_type<One>, std::move(*one)));
  return one != nullptr;
}

template <std::size_t... i>
bool append_any(std::any& command, std::vector<Command>& commands, std::index_sequence<i...>) {
  return (append_as<std::variant_alternative_t<i, Command>>(command, commands) || ...);
}

}  // namespace

void Outbox::apply(Action action, bool joined) {
  add(ApplyEdit{std::move(action), joined});
}

void Outbox::preview(std::optional<Action> action) {
  add(PreviewEdit{std::move(action)});
}

bool Outbox::empty() const {
  return commands_.empty();
}

std::vector<Command> Outbox::take() {
  return std::exchange(commands_, {});
}

void Outbox::add(Command command) {
  commands_.push_back(std::move(command));
}

void Outbox::add_one(std::any command) {
  const bool known = append_any(command, commands_, std::make_index_sequence<std::variant_size_v<Command>>());
  assert(known);
  static_cast<void>(known);
}

}  // namespace homolog
