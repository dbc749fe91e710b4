// A stand-in for rclcpp and four types of messages: what the example of a node uses of them. `spin`
// reads lines `NANOSECONDS TOPIC NUMBER`, and prints what is published; TOPIC `time` lets time pass.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <iostream>
#include <map>
#include <memory>
#include <string>

namespace nav_msgs::msg {
struct Odometry {
    using ConstSharedPtr = std::shared_ptr<const Odometry>;
    struct { struct { struct { double x = 0, y = 0, z = 0; } linear; } twist; } twist;
    void set(double value) { twist.twist.linear.x = value; }
};
} // namespace nav_msgs::msg
namespace sensor_msgs::msg {
struct Range {
    using ConstSharedPtr = std::shared_ptr<const Range>;
    float range = 0;
    void set(double value) { range = static_cast<float>(value); }
};
} // namespace sensor_msgs::msg
namespace std_msgs::msg {
struct Bool {
    using ConstSharedPtr = std::shared_ptr<const Bool>;
    bool data = false;
    void set(double value) { data = value != 0; }
};
struct String {
    std::string data;
};
} // namespace std_msgs::msg

namespace rclcpp {
inline std::int64_t stub_now = 0;
inline std::map<std::string, std::function<void(double)>> stub_subscriptions;
inline std::function<void()> stub_timer;

struct Time {
    std::int64_t nanoseconds() const { return stub_now; }
};
struct Clock {
    using SharedPtr = std::shared_ptr<Clock>;
};
struct Logger {};
struct QoS {
    QoS(int) {}
};
struct SensorDataQoS : QoS {
    SensorDataQoS() : QoS(5) {}
};
struct TimerBase {
    using SharedPtr = std::shared_ptr<TimerBase>;
};
template <class Message> struct Subscription {
    using SharedPtr = std::shared_ptr<Subscription>;
};
template <class Message> struct Publisher {
    using SharedPtr = std::shared_ptr<Publisher>;
    void publish(const Message &message) { std::cout << message.data << std::endl; }
};

class Node {
public:
    explicit Node(const std::string &) {}
    template <class Message>
    typename Publisher<Message>::SharedPtr create_publisher(const std::string &, const QoS &)
    {
        return std::make_shared<Publisher<Message>>();
    }
    template <class Message, class Callback>
    typename Subscription<Message>::SharedPtr
    create_subscription(const std::string &topic, const QoS &, Callback callback)
    {
        stub_subscriptions[topic] = [callback](double value) {
            auto message = std::make_shared<Message>();
            message->set(value);
            callback(message);
        };
        return std::make_shared<Subscription<Message>>();
    }
    Time now() const { return {}; }
    Clock::SharedPtr get_clock() { return nullptr; }
    Logger get_logger() const { return {}; }
};

template <class Period>
TimerBase::SharedPtr create_timer(Node *, Clock::SharedPtr, Period, std::function<void()> callback)
{
    stub_timer = callback;
    return nullptr;
}
inline void init(int, char **) {}
inline void shutdown() {}
inline void spin(std::shared_ptr<Node>)
{
    std::string topic;
    double value;
    while (std::cin >> stub_now >> topic >> value) {
        topic == "time" ? stub_timer() : stub_subscriptions.at(topic)(value);
    }
}
} // namespace rclcpp

#define RCLCPP_ERROR(logger, ...) ((void)(logger))
