#include <cnoid/ControllerIO>
#include <cnoid/YAMLReader>
#include <iostream>
#include <stdexcept>

namespace cnoid {

namespace {

/// Reads an option string from left to right.
class OptionSplitter {
 public:
  explicit OptionSplitter(const std::string& text) : text_(text) {}

  std::vector<std::string> split() {
    for (; place_ < text_.size(); ++place_) {
      const char c = text_[place_];
      if (c == '\\') {
        option_ += escaped();
      } else if (c == '"') {
        quote_ = inQuote() ? std::string::npos : place_;
      } else if (c == ' ' && !inQuote()) {
        finishOption();
      } else {
        option_ += c;
      }
    }
    if (inQuote()) fail("a quote is opened and never closed", quote_);
    finishOption();
    return std::move(options_);
  }

 private:
  bool inQuote() const { return quote_ != std::string::npos; }

  char escaped() {
    const std::size_t backslash = place_++;
    if (place_ == text_.size()) fail("a backslash ends it", backslash);
    const char c = text_[place_];
    if (c == 'n') return '\n';
    if (c == '"' || c == '\\' || c == ' ') return c;
    fail("a backslash stands before '" + std::string(1, c) + "' (it may before n, a quote, a space and a backslash)",
         backslash);
  }

  void finishOption() {
    if (!option_.empty()) options_.push_back(option_);
    option_.clear();
  }

  [[noreturn]] void fail(const std::string& what, std::size_t place) const {
    throw std::invalid_argument("option string, character " + std::to_string(place + 1) + ": " + what + ": " + text_);
  }

  const std::string& text_;
  std::size_t place_ = 0;
  std::size_t quote_ = std::string::npos;  // position of the opening quote
  std::string option_;
  std::vector<std::string> options_;
};

}  // namespace

ControllerIO::~ControllerIO() = default;

std::vector<std::string> ControllerIO::options() const { return splitOptions(optionString()); }

std::vector<std::string> ControllerIO::splitOptions(const std::string& optionString) {
  return OptionSplitter(optionString).split();
}

MappingPtr ControllerIO::structuredOptions() const {
  YAMLReader reader;
  if (!reader.parse(optionString())) {
    os() << controllerName() << ": the options are no YAML: " << reader.errorMessage() << std::endl;
    return nullptr;
  }
  if (reader.numDocuments() == 0) return new Mapping;
  if (!reader.document()->isMapping()) {
    os() << controllerName() << ": the options are no YAML mapping (name: value): " << optionString() << std::endl;
    return nullptr;
  }
  return reader.document()->toMapping();
}

std::ostream& ControllerIO::os() const { return std::cout; }

MessageOut* ControllerIO::mout() const {
  if (!mout_) mout_ = new MessageOut(os());
  return mout_;
}

bool ControllerIO::isSimulationFromInitialState() const { return true; }

std::shared_ptr<BodyMotion> ControllerIO::logBodyMotion() { return nullptr; }

SignalProxy<void()> ControllerIO::sigLogFlushRequested() { return {}; }

bool ControllerIO::enableLog() { return false; }

void ControllerIO::outputLogFrame(Referenced* logFrame) {
  const ReferencedPtr owner(logFrame);  // takes ownership, so that the object is deleted here if nothing else owns it
}

std::string ControllerIO::getIntegratedOptionString(const std::string& first, const std::string& second) {
  if (first.empty() || second.empty()) return first + second;
  return first + " " + second;
}

}  // namespace cnoid
