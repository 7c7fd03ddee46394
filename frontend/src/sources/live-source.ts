import { ReconnectingSource, socketAddress } from "./reconnecting";

/**
 * The incident as it is now. After a break the server begins with a whole frame again, so nothing
 * that happened in between is missing from the picture.
 */
export class LiveSource extends ReconnectingSource {
  constructor(incident: string) {
    super(() => socketAddress(`/api/v1/incidents/${encodeURIComponent(incident)}/live`));
  }
}
