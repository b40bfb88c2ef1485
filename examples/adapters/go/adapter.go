// A robot in memory behind missionfsm's adapter protocol: put your own in its place; `go build adapter.go` builds it.
package main

import (
	"encoding/json"
	"fmt"
	"os"
	"time"
)

const declared = `{"implementation": {"name": "starter in Go", "version": "1"},
	"drives": ["goalReached", "missionFailed"], "methods": ["CreateMission", "SubscribeMissionStatus"],
	"worlds": "fixed", "world": {"family": "base", "destinations": ["kitchen", "table-1"]},
	"requests": "binary"}` // nothing of a wrong type is sent: your gRPC library would not let it in either
type object = map[string]any

var destinations = map[any]bool{"kitchen": true, "table-1": true}
var ends = map[any]string{"goalReached": "STATE_SUCCEEDED", "missionFailed": "STATE_FAILED"}
var missions, current = []object{}, -1 // in their order; the index of the one that runs, -1 for none
var streams = map[any]string{}         // each stream, with what it was shown last
var streamNumber, sequence = 0, 0      // none comes twice, not even after a reset

func at(value any, path ...string) any { // what stands in an object of objects, or nil
	for _, name := range path {
		inside, _ := value.(object)
		value = inside[name]
	}
	return value
}

func refusal(code int, status, message string) object {
	return object{"error": object{"code": code, "message": message, "data": object{"status": status}}}
}

func create(wanted any) object {
	kind, goals := "BASE_TYPE_NAVIGATE", []any{at(wanted, "navigateMission", "goal")}
	if list, _ := at(wanted, "navigateAutoMission", "goals").([]any); len(list) > 0 {
		kind, goals = "BASE_TYPE_NAVIGATE_AUTO", list
	}
	for _, goal := range goals {
		pose, isPose := at(goal, "pose").(object)
		for _, number := range pose {
			_, finite := number.(float64) // NaN and the infinities are texts
			isPose = isPose && finite
		}
		if !isPose && !destinations[at(goal, "destinationId")] {
			return refusal(3, "INVALID_ARGUMENT", "what is needed is a base mission, with goals that are on the map")
		}
	}
	if current >= 0 {
		return refusal(9, "FAILED_PRECONDITION", "a mission is running")
	}
	current = len(missions)
	name, is := fmt.Sprintf("mission-%d", current+1), object{"baseType": kind}
	missions = append(missions, object{"missionId": name, "state": "STATE_RUNNING", "goals": goals, "missionType": is})
	return object{"result": object{"missionId": name}}
}

func answer(method any, params any) object {
	result := object{}
	switch method {
	case "initialize":
		json.Unmarshal([]byte(declared), &result)
	case "CreateMission":
		return create(at(params, "mission", "baseMission"))
	case "SubscribeMissionStatus":
		streamNumber++
		result["stream"], streams[float64(streamNumber)] = streamNumber, "" // a number is a float64 in JSON
	case "drive":
		if result["happened"] = current >= 0; current >= 0 {
			missions[current]["state"], current = ends[at(params, "event")], -1
		}
	case "reset":
		missions, current, streams = []object{}, -1, map[any]string{}
	case "cancel":
		delete(streams, at(params, "stream"))
	case "settle": // nothing is under way: what was caused has been written
	default:
		return refusal(-32601, "METHOD_NOT_FOUND", fmt.Sprint("there is no ", method))
	}
	return object{"result": result}
}

func main() {
	in, out := json.NewDecoder(os.Stdin), json.NewEncoder(os.Stdout)
	for asked := (object{}); in.Decode(&asked) == nil; asked = (object{}) {
		line := answer(asked["method"], asked["params"])
		line["jsonrpc"], line["id"] = "2.0", asked["id"]
		out.Encode(line)
		states := object{"missions": missions, "currentMissionIndex": current}
		for stream, shown := range streams {
			if now := fmt.Sprint(states); now != shown {
				streams[stream], sequence = now, sequence+1
				message := object{"metadata": object{"timestamp": time.Now(), "sequenceNumber": sequence}, "missionStates": states}
				out.Encode(object{"jsonrpc": "2.0", "method": "message", "params": object{"stream": stream, "message": message}})
			}
		}
	}
}
