#include "src/config/one_document.hpp"

#include <yaml-cpp/eventhandler.h>

#include <sstream>

namespace taut::config {

namespace {

/// Takes note of the first content behind the first document.
class Second : public YAML::EventHandler {
public:
  std::optional<YAML::Mark> mark;

  void OnDocumentStart(const YAML::Mark&) override { ++documents_; }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& m, YAML::anchor_t) override { content(m); }
  void OnAlias(const YAML::Mark& m, YAML::anchor_t) override { content(m); }
  void OnScalar(const YAML::Mark& m, const std::string&, YAML::anchor_t, const std::string&) override {
    content(m);
  }
  void OnSequenceStart(const YAML::Mark& m, const std::string&, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {
    content(m);
  }
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark& m, const std::string&, YAML::anchor_t,
                  YAML::EmitterStyle::value) override {
    content(m);
  }
  void OnMapEnd() override {}

private:
  void content(const YAML::Mark& m) {
    if (documents_ > 1 && !mark) mark = m;
  }

  int documents_ = 0;
};

} // namespace

std::optional<YAML::Mark> second_document(const std::string& text) {
  std::istringstream in(text);
  YAML::Parser parser(in);
  Second second;
  parser.HandleNextDocument(second);
  parser.HandleNextDocument(second);
  return second.mark;
}

} // namespace taut::config
