#include "link/control/lease_news.hpp"

#include <utility>

#include "common/text.hpp"

namespace foresight {
namespace {

void add(std::string& to, const std::string& words) {
  to += (to.empty() ? "" : "; ") + words;
}

std::string lease_words(const std::string& holder, const std::string& before) {
  if (holder.empty()) return "nobody commands, no longer " + in_quotes(before);
  return in_quotes(holder) + " commands" + (before.empty() ? "" : ", no longer " + in_quotes(before));
}

}  // namespace

std::string LeaseNews::of(ControlDesk& desk, RobotTime now) {
  std::string out;
  if (const Nonce before = std::exchange(lease_, desk.permit().lease()); lease_ != before)
    add(out, lease_words(desk.holder_name(), std::exchange(holder_, desk.holder_name())));
  const std::string before = std::exchange(asking_, desk.asking_name(now));
  if (!asking_.empty() && asking_ != before) add(out, in_quotes(asking_) + " asks for control");
  return out;
}

std::string LeaseNews::line() const {
  std::string out;
  if (!holder_.empty()) add(out, in_quotes(holder_) + " commands");
  if (!asking_.empty()) add(out, in_quotes(asking_) + " asks for control: g gives it");
  return out;
}

}  // namespace foresight
