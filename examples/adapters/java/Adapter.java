// A robot in memory behind missionfsm's adapter protocol: put your own in its place.
// javac -cp /usr/share/java/gson.jar -d build examples/adapters/java/Adapter.java
// missionfsm conform bear.mission -- java -cp /usr/share/java/gson.jar:build Adapter

import com.google.gson.*;
import java.io.*;
import java.nio.charset.StandardCharsets;
import java.time.Instant;
import java.util.*;

/** Missions in their order, of which the first that has not ended runs. */
public final class Adapter {
    static final String DECLARED = """
        {"implementation": {"name": "starter in Java", "version": "1"},
         "drives": ["goalReached", "missionFailed"],
         "methods": ["CreateMission", "AppendMission", "SubscribeMissionStatus"],
         "worlds": "fixed", "world": {"family": "base", "destinations": ["kitchen", "table-1", "table-2"]},
         "requests": "binary"}"""; // nothing of a wrong type is sent: your gRPC library would not let it in either
    static final Set<String> DESTINATIONS = Set.of("kitchen", "table-1", "table-2");
    static final Map<String, Integer> CODES =
        Map.of("INVALID_ARGUMENT", 3, "FAILED_PRECONDITION", 9, "METHOD_NOT_FOUND", -32601);
    static final Map<String, String> TYPES =
        Map.of("navigateMission", "BASE_TYPE_NAVIGATE", "navigateAutoMission", "BASE_TYPE_NAVIGATE_AUTO");
    static final Map<String, String> ENDS = Map.of("goalReached", "STATE_SUCCEEDED", "missionFailed", "STATE_FAILED");

    static final PrintStream OUT = new PrintStream(System.out, true, StandardCharsets.UTF_8); // flushes every line
    static final Gson JSON = new Gson();
    static final List<JsonObject> missions = new ArrayList<>(); // in their order
    static final Map<Integer, String> streams = new TreeMap<>(); // each stream, with what it was shown last
    static int streamNumber; // none comes twice, not even after a reset
    static int sequenceNumber; // likewise

    public static void main(String[] args) throws IOException {
        var in = new BufferedReader(new InputStreamReader(System.in, StandardCharsets.UTF_8));
        for (String line = in.readLine(); line != null; line = in.readLine()) {
            JsonObject asked = JSON.fromJson(line, JsonObject.class);
            JsonObject reply = answer(asked.get("method").getAsString(), asked.getAsJsonObject("params"));
            reply.addProperty("jsonrpc", "2.0");
            reply.add("id", asked.get("id"));
            OUT.println(reply);
            show();
        }
    }

    static JsonObject answer(String method, JsonObject params) {
        JsonObject result = object();
        switch (method) {
            case "initialize" -> result = JSON.fromJson(DECLARED, JsonObject.class);
            case "reset" -> {
                missions.clear();
                streams.clear();
            }
            case "settle" -> { } // nothing is under way: what was caused has been written
            case "cancel" -> streams.remove(params.get("stream").getAsInt());
            case "drive" -> {
                JsonObject mission = current();
                if (mission != null) {
                    mission.addProperty("state", ENDS.get(params.get("event").getAsString()));
                }
                result.addProperty("happened", mission != null);
            }
            case "SubscribeMissionStatus" -> {
                streams.put(++streamNumber, "");
                result.addProperty("stream", streamNumber);
            }
            case "CreateMission", "AppendMission" -> {
                return assign(params, method.equals("CreateMission"));
            }
            default -> {
                return refusal("METHOD_NOT_FOUND", "there is no " + method);
            }
        }
        return object("result", result);
    }

    static JsonObject refusal(String status, String message) {
        var data = object("status", status);
        return object("error", object("code", CODES.get(status), "message", message, "data", data));
    }

    static JsonObject assign(JsonObject request, boolean first) {
        JsonObject base = inside(inside(request, "mission"), "baseMission");
        String kind = base.keySet().stream().findFirst().orElse("");
        JsonObject wanted = inside(base, kind);
        List<JsonElement> goals =
            wanted.has("goals") ? wanted.getAsJsonArray("goals").asList() : List.of(inside(wanted, "goal"));
        if (goals.isEmpty() || !goals.stream().allMatch(goal -> isGoal(goal.getAsJsonObject()))) {
            return refusal("INVALID_ARGUMENT", "what is needed is a base mission, with goals that are on the map");
        }
        if (first && current() != null) {
            return refusal("FAILED_PRECONDITION", "a mission is running or waiting");
        }
        if (!first && missions.isEmpty()) {
            return refusal("FAILED_PRECONDITION", "there is no mission to append to");
        }
        String name = "mission-" + (missions.size() + 1);
        missions.add(object("missionId", name, "state", "STATE_DEFAULT", "goals", goals,
            "missionType", object("baseType", TYPES.get(kind))));
        return object("result", object("missionId", name));
    }

    static boolean isGoal(JsonObject goal) {
        if (goal.has("pose")) {
            var numbers = inside(goal, "pose").asMap().values().stream();
            return numbers.allMatch(one -> Double.isFinite(one.getAsDouble()));
        }
        return goal.has("destinationId") && DESTINATIONS.contains(goal.get("destinationId").getAsString());
    }

    /** The mission that runs, or null. */
    static JsonObject current() {
        return missions.stream()
            .filter(one -> !ENDS.containsValue(one.get("state").getAsString())).findFirst().orElse(null);
    }

    /** Whatever happened: what is next starts, and every stream that was not shown how things are is shown it. */
    static void show() {
        JsonObject current = current();
        if (current != null) {
            current.addProperty("state", "STATE_RUNNING");
        }
        var states = object("missions", JSON.toJsonTree(missions), "currentMissionIndex", missions.indexOf(current));
        for (var stream : streams.entrySet()) {
            if (!stream.getValue().equals(states.toString())) {
                stream.setValue(states.toString());
                var metadata = object("timestamp", Instant.now().toString(), "sequenceNumber", ++sequenceNumber);
                var message = object("metadata", metadata, "missionStates", states);
                OUT.println(object("jsonrpc", "2.0", "method", "message",
                    "params", object("stream", stream.getKey(), "message", message)));
            }
        }
    }

    /** An object of names and values, alternating. */
    static JsonObject object(Object... members) {
        var made = new JsonObject();
        for (int i = 0; i < members.length; i += 2) {
            made.add((String) members[i], JSON.toJsonTree(members[i + 1]));
        }
        return made;
    }

    /** The object inside an object, empty if there is none. */
    static JsonObject inside(JsonObject outer, String name) {
        return outer.has(name) ? outer.getAsJsonObject(name) : new JsonObject();
    }
}
