// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>
#include <mpi.h>

#include <cstdint>
#include <exception>
#include <limits>
#include <numeric>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "controlspace/error.h"

namespace controlspace {

/// The ranks of a communicator, and what this one has sent: to each other rank one message a
/// collective call, as if no rank forwarded messages of others.
class Ranks {
public:
    explicit Ranks(MPI_Comm comm) : comm_(comm) {
        MPI_Comm_rank(comm, &rank_);
        MPI_Comm_size(comm, &size_);
    }

    MPI_Comm comm() const { return comm_; }
    int rank() const { return rank_; }
    int size() const { return size_; }
    std::uint64_t bytes() const { return bytes_; }
    std::uint64_t messages() const { return messages_; }

    /// Calls `work`, which must not communicate; what it throws on any rank is thrown on all, as an
    /// InputError: that of the first of these ranks.
    template <class Work>
    void together(const Work& work) {
        std::optional<std::string> failure;
        try {
            work();
        } catch (const std::bad_alloc&) {
            failure = "out of memory: give more ranks, or fewer sources";
        } catch (const std::exception& error) {
            failure = error.what();
        }
        const int first = least(failure ? rank_ : size_);
        if (first == size_) return;
        std::vector<char> text;
        if (rank_ == first) text.assign(failure->begin(), failure->end());
        text = broadcast(text, first);
        throw InputError(size_ == 1 ? std::string(text.begin(), text.end())
                                    : fmt::format("rank {}: {}", first,
                                                  std::string_view(text.data(), text.size())));
    }

    int least(int value) {
        all_reduce(&value, 1, MPI_INT, MPI_MIN);
        return value;
    }
    /// Of each entry the least, largest or sum on all ranks.
    template <class T>
    void reduce(std::vector<T>& values, MPI_Op op) {
        all_reduce(values.data(), count_of(values.size()), type_of<T>(), op);
    }
    template <class T>
    T reduced(T value, MPI_Op op) {
        all_reduce(&value, 1, type_of<T>(), op);
        return value;
    }
    /// The sum over the ranks before this one.
    std::uint64_t sum_before(std::uint64_t value) {
        std::uint64_t sum = 0;
        MPI_Exscan(&value, &sum, 1, MPI_UINT64_T, MPI_SUM, comm_);
        return rank_ == 0 ? 0 : sum;
    }

    /// What rank `from` has.
    template <class T>
    std::vector<T> broadcast(std::vector<T> values, int from) {
        std::uint64_t count = values.size();
        MPI_Bcast(&count, 1, MPI_UINT64_T, from, comm_);
        values.resize(count);
        const Raw<T> raw;
        MPI_Bcast(values.data(), count_of(count), raw.type, from, comm_);
        if (rank_ == from) note_all(count * sizeof(T));
        return values;
    }

    /// Values of all ranks in their order; the number of each.
    template <class T>
    struct Gathered {
        std::vector<T> values;
        std::vector<int> counts;
    };
    template <class T>
    Gathered<T> gather(const std::vector<T>& own) {
        Gathered<T> all;
        all.counts.resize(static_cast<std::size_t>(size_));
        const int count = count_of(own.size());
        MPI_Allgather(&count, 1, MPI_INT, all.counts.data(), 1, MPI_INT, comm_);
        const std::vector<int> begins = begins_of(all.counts);
        all.values.resize(static_cast<std::size_t>(begins.back()));
        const Raw<T> raw;
        MPI_Allgatherv(own.data(), count, raw.type, all.values.data(), all.counts.data(),
                       begins.data(), raw.type, comm_);
        note_all(own.size() * sizeof(T));
        return all;
    }

    /// Sends to[r] to each rank r.
    template <class T>
    Gathered<T> exchange(const std::vector<std::vector<T>>& to) {
        std::vector<int> out;
        std::vector<T> values;
        for (std::size_t r = 0; r < to.size(); ++r) {
            out.push_back(count_of(to[r].size()));
            values.insert(values.end(), to[r].begin(), to[r].end());
            if (static_cast<int>(r) == rank_ || to[r].empty()) continue;
            bytes_ += to[r].size() * sizeof(T);
            ++messages_;
        }
        Gathered<T> all;
        all.counts.resize(to.size());
        MPI_Alltoall(out.data(), 1, MPI_INT, all.counts.data(), 1, MPI_INT, comm_);
        const std::vector<int> begins_out = begins_of(out);
        const std::vector<int> begins = begins_of(all.counts);
        all.values.resize(static_cast<std::size_t>(begins.back()));
        const Raw<T> raw;
        MPI_Alltoallv(values.data(), out.data(), begins_out.data(), raw.type, all.values.data(),
                      all.counts.data(), begins.data(), raw.type, comm_);
        return all;
    }

private:
    // So that counts are those of values.
    template <class T>
    struct Raw {
        // Eigen's vectors have constructors, but are nothing but numbers.
        static_assert(std::is_trivially_destructible_v<T> && std::is_standard_layout_v<T>);
        MPI_Datatype type;
        Raw() {
            MPI_Type_contiguous(sizeof(T), MPI_BYTE, &type);
            MPI_Type_commit(&type);
        }
        ~Raw() { MPI_Type_free(&type); }
        Raw(const Raw&) = delete;
        Raw& operator=(const Raw&) = delete;
    };

    template <class T>
    static MPI_Datatype type_of() {
        if constexpr (std::is_same_v<T, double>) {
            return MPI_DOUBLE;
        } else if constexpr (std::is_same_v<T, std::uint64_t>) {
            return MPI_UINT64_T;
        } else {
            static_assert(std::is_same_v<T, int>);
            return MPI_INT;
        }
    }
    // More would need the large counts of MPI 4. Other ranks cannot be notified any more.
    int count_of(std::size_t n) const {
        if (n <= static_cast<std::size_t>(std::numeric_limits<int>::max())) return int(n);
        fmt::print(stderr, "rank {} would send {} records at once: give more ranks\n", rank_, n);
        MPI_Abort(comm_, 1);
        return 0;
    }
    std::vector<int> begins_of(const std::vector<int>& counts) const {
        std::vector<int> begins{0};
        std::uint64_t end = 0;
        for (const int n : counts) begins.push_back(count_of(end += static_cast<std::uint64_t>(n)));
        return begins;
    }
    void note_all(std::size_t bytes) {
        bytes_ += bytes * static_cast<std::uint64_t>(size_ - 1);
        messages_ += static_cast<std::uint64_t>(size_ - 1);
    }
    void all_reduce(void* values, int count, MPI_Datatype type, MPI_Op op) {
        MPI_Allreduce(MPI_IN_PLACE, values, count, type, op, comm_);
        int bytes = 0;
        MPI_Type_size(type, &bytes);
        note_all(static_cast<std::size_t>(count) * static_cast<std::size_t>(bytes));
    }

    MPI_Comm comm_;
    int rank_ = 0, size_ = 1;
    std::uint64_t bytes_ = 0, messages_ = 0;
};

}  // namespace controlspace
