#include "server/net/admitted_transport.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "server/net/soon.hpp"

namespace trochoid {

namespace {

class AdmittedTransport final : public Transport {
public:
    AdmittedTransport(IoLoop& loop, std::unique_ptr<Transport> inner, std::span<const uint8_t> first,
                      std::shared_ptr<void> place)
        : place_(std::move(place)),
          inner_(std::move(inner)),
          first_(first.begin(), first.end()),
          soon_(loop) {}

    const std::string& peer() const override { return inner_->peer(); }
    void when_readable(std::function<void()> ready) override {
        if (first_.empty())
            inner_->when_readable(std::move(ready));
        else
            soon_.call(std::move(ready));
    }
    void when_writable(std::function<void()> ready) override { inner_->when_writable(std::move(ready)); }
    Moved read(std::span<uint8_t> into) override {
        if (first_.empty()) return inner_->read(into);
        const size_t bytes = std::min(into.size(), first_.size());
        std::copy_n(first_.begin(), bytes, into.begin());
        if (bytes == first_.size())
            first_ = {};
        else
            first_.erase(first_.begin(), first_.begin() + static_cast<std::ptrdiff_t>(bytes));
        return {bytes, false};
    }
    Moved write(std::span<const uint8_t> bytes) override { return inner_->write(bytes); }
    void finish(ErrorCode why) override { inner_->finish(why); }
    void close() override {
        soon_.forget();
        inner_->close();
    }
    std::optional<StreamFault> fault() const override { return inner_->fault(); }
    void set_longest(uint32_t payload) override { inner_->set_longest(payload); }

private:
    std::shared_ptr<void> place_;  // outlives the stream
    std::unique_ptr<Transport> inner_;
    std::vector<uint8_t> first_;
    Soon soon_;
};

}  // namespace

std::unique_ptr<Transport> give_back(IoLoop& loop, std::unique_ptr<Transport> inner,
                                     std::span<const uint8_t> first, std::shared_ptr<void> place) {
    return std::make_unique<AdmittedTransport>(loop, std::move(inner), first, std::move(place));
}

}  // namespace trochoid
