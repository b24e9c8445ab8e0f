#pragma once
#include "partition/comm.hpp"

#include <algorithm>

namespace taut {

/// A fixed communication pattern: which of this rank's values go to which neighbour, and where the values of
/// each neighbour land. Made once, applied many times; one message a pair of neighbours. A part of the
/// pattern may lead from a rank to itself.
class Plan {
public:
  Plan() = default;

  /// `send_to[i]` is the rank that gets the value at `send_index[i]`. Values from one rank arrive in the
  /// order of that rank's list; `receive_index` says where each arrival (by rank, then in order) is put.
  /// Collective.
  Plan(MPI_Comm comm, std::span<const int> send_to, std::span<const Local> send_index,
       std::vector<Local> receive_index);

  /// target[receive_index] = source[send_index], over all ranks. Collective over neighbours.
  template<class T>
  void forward(std::span<const T> source, std::span<T> target) const {
    begin_forward(source);
    end_forward(target);
  }

  /// The two halves of `forward`: work that needs no arrival may stand between them.
  template<class T>
  void begin_forward(std::span<const T> source) const {
    T* out = buffer<T>(out_, send_index_.size());
    for (std::size_t i = 0; i < send_index_.size(); ++i) out[i] = source[send_index_[i]];
    buffer<T>(in_, receive_index_.size());
    start(send_, receive_, out_, in_, sizeof(T));
  }
  template<class T>
  void end_forward(std::span<T> target) const {
    finish();
    const T* in = reinterpret_cast<const T*>(in_.data());
    for (std::size_t i = 0; i < receive_index_.size(); ++i) target[receive_index_[i]] = in[i];
  }

  /// target[receive_index] += source[send_index].
  template<class T>
  void forward_add(std::span<const T> source, std::span<T> target) const {
    begin_forward(source);
    finish();
    const T* in = reinterpret_cast<const T*>(in_.data());
    for (std::size_t i = 0; i < receive_index_.size(); ++i) target[receive_index_[i]] += in[i];
  }

  /// target[send_index] = source[receive_index]: the same pattern the other way.
  template<class T>
  void reverse(std::span<const T> source, std::span<T> target) const {
    run_reverse(source);
    const T* in = reinterpret_cast<const T*>(in_.data());
    for (std::size_t i = 0; i < send_index_.size(); ++i) target[send_index_[i]] = in[i];
  }

  /// target[send_index] += source[receive_index].
  template<class T>
  void reverse_add(std::span<const T> source, std::span<T> target) const {
    run_reverse(source);
    const T* in = reinterpret_cast<const T*>(in_.data());
    for (std::size_t i = 0; i < send_index_.size(); ++i) target[send_index_[i]] += in[i];
  }

  /// target[send_index] = min(target[send_index], source[receive_index]).
  template<class T>
  void reverse_min(std::span<const T> source, std::span<T> target) const {
    run_reverse(source);
    const T* in = reinterpret_cast<const T*>(in_.data());
    for (std::size_t i = 0; i < send_index_.size(); ++i)
      target[send_index_[i]] = std::min(target[send_index_[i]], in[i]);
  }

  /// Gives back the memory of the messages, for a plan that is used rarely.
  void release_buffers() const {
    std::vector<std::byte>().swap(out_); // assigning {} would keep it
    std::vector<std::byte>().swap(in_);
  }

  int neighbours() const { return int(receive_.ranks.size()); }
  std::size_t sent() const { return send_index_.size(); }

private:
  struct Side {
    std::vector<int> ranks;
    std::vector<std::size_t> offsets{0};
  };

  template<class T>
  static T* buffer(std::vector<std::byte>& bytes, std::size_t count) {
    bytes.resize(count * sizeof(T));
    return reinterpret_cast<T*>(bytes.data());
  }
  template<class T>
  void run_reverse(std::span<const T> source) const {
    T* out = buffer<T>(out_, receive_index_.size());
    for (std::size_t i = 0; i < receive_index_.size(); ++i) out[i] = source[receive_index_[i]];
    buffer<T>(in_, send_index_.size());
    start(receive_, send_, out_, in_, sizeof(T));
    finish();
  }
  void start(const Side& to, const Side& from, std::span<const std::byte> out, std::span<std::byte> in,
             std::size_t item_size) const;
  void finish() const;

  MPI_Comm comm_ = MPI_COMM_NULL;
  Side send_, receive_;
  std::vector<Local> send_index_, receive_index_;
  mutable std::vector<std::byte> out_, in_; // kept so that a step allocates nothing
  mutable std::vector<MPI_Request> requests_;
};

} // namespace taut
