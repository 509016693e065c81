#include "calibration/result/verdict.hpp"

namespace foresight {

void Verdict::object(std::string what, std::string cure) {
  Objection& objection = against.emplace_back();
  objection.what = std::move(what);
  objection.cure = std::move(cure);
}

void Verdict::add(const Verdict& other) {
  against.insert(against.end(), other.against.begin(), other.against.end());
}

std::string Verdict::text() const {
  if (usable()) return "usable";
  std::string out;
  for (const Objection& objection : against)
    out += (out.empty() ? "NOT USABLE: " : "\nNOT USABLE: ") + objection.text();
  return out;
}

}  // namespace foresight
