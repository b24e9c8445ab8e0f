#include "src/output/frame_formats.hpp"

#include "src/output/pc2_sink.hpp"
#include "src/output/xdmf_sink.hpp"

#include <algorithm>

namespace taut {

namespace {

namespace fs = std::filesystem;

struct Format {
  config::FrameFormat name;
  std::unique_ptr<FrameSink> (*make)(const FrameSource&);
  const char* file;
  Global (*count_frames)(const fs::path&);
  void (*drop_frames)(const fs::path&, Global);
};

template<class Sink>
std::unique_ptr<FrameSink> make_sink(const FrameSource& source) {
  return std::make_unique<Sink>(source);
}

template<class Sink>
constexpr Format format_of(config::FrameFormat name) {
  return {name, make_sink<Sink>, Sink::file, Sink::count_frames, Sink::drop_frames};
}

constexpr std::array all_formats{
    format_of<XdmfSink>(config::FrameFormat::xdmf),
    format_of<Pc2Sink>(config::FrameFormat::pc2),
};

bool is_in(std::span<const config::FrameFormat> wanted, const Format& format) {
  return std::find(wanted.begin(), wanted.end(), format.name) != wanted.end();
}

} // namespace

std::vector<std::unique_ptr<FrameSink>> make_sinks(const FrameSource& source,
                                                   std::span<const config::FrameFormat> wanted) {
  std::vector<std::unique_ptr<FrameSink>> sinks;
  for (const Format& f : all_formats)
    if (is_in(wanted, f)) sinks.push_back(f.make(source));
  return sinks;
}

std::vector<const char*> files_of(std::span<const config::FrameFormat> wanted) {
  std::vector<const char*> files;
  for (const Format& f : all_formats)
    if (is_in(wanted, f)) files.push_back(f.file);
  return files;
}

bool holds_frames(const fs::path& folder) {
  return std::any_of(all_formats.begin(), all_formats.end(),
                     [&](const Format& f) { return fs::exists(folder / f.file); });
}

Global count_frames(const fs::path& folder) {
  Global most = 0;
  for (const Format& f : all_formats) most = std::max(most, f.count_frames(folder));
  return most;
}

void drop_frames(const fs::path& folder, Global first) {
  for (const Format& f : all_formats) f.drop_frames(folder, first);
}

} // namespace taut
