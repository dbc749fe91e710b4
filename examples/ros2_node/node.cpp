// A ROS 2 node that judges base.rv on the robot in C, without Python. It publishes each verdict as a line on `verdicts`, such as `B2#1 F`.
//
// It was compiled and run with a stub of rclcpp, not with ROS.
#include "base_plan.h"
#include "rvmon_core.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <initializer_list>
#include <memory>
#include <stdexcept>
#include <string>

#include <nav_msgs/msg/odometry.hpp>
#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/range.hpp>
#include <std_msgs/msg/bool.hpp>
#include <std_msgs/msg/string.hpp>

class BaseMonitor : public rclcpp::Node {
public:
    BaseMonitor()
        : Node("base_monitor"),
          verdicts_(create_publisher<std_msgs::msg::String>("verdicts", 100)),
          monitor_(base_plan, sizeof base_plan)
    {
        if (!monitor_) {
            throw std::runtime_error("no memory for the monitor");
        }
        const auto qos = rclcpp::SensorDataQoS();
        odom_ = create_subscription<nav_msgs::msg::Odometry>(
            "odom", qos, [this](nav_msgs::msg::Odometry::ConstSharedPtr message) {
                const auto &velocity = message->twist.twist.linear;
                step({rvmon::real(BASE_SIGNAL_SPEED, std::hypot(velocity.x, velocity.y))});
            });
        range_ = create_subscription<sensor_msgs::msg::Range>(
            "range", qos, [this](sensor_msgs::msg::Range::ConstSharedPtr message) {
                step({rvmon::real(BASE_SIGNAL_OBSTACLE, message->range)});
            });
        stop_ = create_subscription<std_msgs::msg::Bool>(
            "stop", 10, [this](std_msgs::msg::Bool::ConstSharedPtr message) {
                if (message->data && !stops_) {
                    step({rvmon::occurs(BASE_EVENT_STOP_REQUEST)});
                }
                stops_ = message->data;
            });
        // The node's clock follows /clock if use_sim_time is set. A missed deadline is reported at
        // most one period late; the decision instant in the record is exact.
        timer_ = rclcpp::create_timer(this, get_clock(), std::chrono::milliseconds(10), [this]() {
            tell(monitor_.advance(now().nanoseconds()));
        });
    }

private:
    void step(std::initializer_list<rv_update> updates) { tell(monitor_.step(later(), updates)); }

    // Each sample needs a later instant than the last, even if two messages arrive at once.
    std::int64_t later() { return last_ = std::max(now().nanoseconds(), last_ + 1); }

    void tell(int code)
    {
        if (code != RV_OK) {
            RCLCPP_ERROR(get_logger(), "the monitor says %d", code);
        }
        monitor_.records([this](const rv_record &record) {
            static const char *const verdicts[] = {"F", "P", "I", "NT"};
            std_msgs::msg::String message;
            message.data = base_requirements[record.requirement];
            message.data += (record.in_doubt ? "?" : "#") + std::to_string(record.number) + " " +
                            verdicts[record.verdict];
            verdicts_->publish(message);
            if (record.verdict == RV_FAIL) {
                RCLCPP_ERROR(get_logger(), "%s", message.data.c_str());
            }
        });
    }

    rclcpp::Publisher<std_msgs::msg::String>::SharedPtr verdicts_;
    rvmon::Monitor monitor_;
    rclcpp::Subscription<nav_msgs::msg::Odometry>::SharedPtr odom_;
    rclcpp::Subscription<sensor_msgs::msg::Range>::SharedPtr range_;
    rclcpp::Subscription<std_msgs::msg::Bool>::SharedPtr stop_;
    rclcpp::TimerBase::SharedPtr timer_;
    std::int64_t last_ = -1;
    bool stops_ = false;
};

int main(int argc, char **argv)
{
    rclcpp::init(argc, argv);
    rclcpp::spin(std::make_shared<BaseMonitor>());
    rclcpp::shutdown();
}
